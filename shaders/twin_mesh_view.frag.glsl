#version 460
// Grey, by how steep the surface is.
layout(location = 0) in vec3 normal;
layout(location = 0) out vec4 colour;

void main() { colour = vec4(vec3(0.3 + 0.4 * normalize(normal).z), 1.0); }
