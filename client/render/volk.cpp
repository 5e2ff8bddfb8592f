// The one place where the Vulkan loader's entry points are defined.
#define VOLK_IMPLEMENTATION
#include <volk.h>
