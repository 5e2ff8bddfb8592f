// The head that every resident form of a facade map begins with, shared by C++ and GLSL. FORMAT.md beside this file
// explains the forms; X_layout.h has the words of form X after the head.
#ifndef CITYSTREAM_CODEC_FACADE_FORM_LAYOUT_H
#define CITYSTREAM_CODEC_FACADE_FORM_LAYOUT_H

#define FACADE_FORM_MAGIC 0x4643u /* "CF": low half of word 0 */
#define FACADE_FORM_WORD_FORM 0   /* magic | form << 16 */
#define FACADE_FORM_WORD_SIZE 1   /* width | height << 16, texels of 1 cm, 1..8192 */
/* least displacement | greatest << 16 of the texels that are not open, int16 millimetres, outwards positive */
#define FACADE_FORM_WORD_DEPTHS 2
#define FACADE_FORM_OWN_WORD 3 /* the first word that means something else in every form */

#define FACADE_FORM_PATCH 1
#define FACADE_FORM_QUOTIENT 2
#define FACADE_FORM_TILED 3
#define FACADE_FORM_RAW 4
#define FACADE_FORM_MAX_MIP 5
#define FACADE_FORM_SVD 6
#define FACADE_FORM_BINARY 7

#define FACADE_OPEN_DISPLACEMENT (-32768) /* of a texel without surface */

#endif
