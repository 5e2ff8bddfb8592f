#version 460
layout(location = 0) in vec3 grid;
layout(location = 0) out vec4 colour;

void main() {
    vec3 normal = normalize(cross(dFdx(grid), dFdy(grid)));
    colour = vec4(normal * 0.5 + 0.5, 1.0);
}
