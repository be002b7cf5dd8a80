// The programs of the graphics card.

const BODY_VERTEX = `#version 300 es
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
uniform mat4 seen, model;
out vec3 world, facing;
void main() {
  vec4 at = model * vec4(position, 1.0);
  world = at.xyz;
  facing = mat3(model) * normal;
  gl_Position = seen * at;
}`;

// A key light with a soft edge, light of sky and ground, a highlight, and a rim against the background.
const BODY_FRAGMENT = `#version 300 es
precision highp float;
in vec3 world, facing;
uniform vec4 colour;
uniform vec3 eye, key, sky, ground;
uniform float shine, lit;
out vec4 shown;
void main() {
  vec3 n = normalize(facing);
  vec3 back = normalize(eye - world);
  if (dot(n, back) < 0.0) n = -n;
  vec3 base = pow(colour.rgb, vec3(2.2));
  float diffuse = max(0.0, (dot(n, key) + 0.25) / 1.25);
  vec3 around = mix(ground, sky, 0.5 + 0.5 * n.z);
  float highlight = pow(max(0.0, dot(n, normalize(key + back))), 48.0) * shine;
  float rim = pow(1.0 - max(0.0, dot(n, back)), 3.0) * 0.18 * shine;
  vec3 light = base * (0.95 * diffuse + around) + vec3(highlight * 0.5 + rim);
  shown = vec4(mix(colour.rgb, pow(min(light, 1.0), vec3(1.0 / 2.2)), lit), colour.a);
}`;

const GRID_VERTEX = `#version 300 es
uniform mat4 seen;
uniform vec4 square;
out vec2 at;
void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
  at = square.xy + corner * square.w;
  gl_Position = seen * vec4(at, square.z, 1.0);
}`;

// Lines one pixel wide, each fifth of them darker, which fade into the distance.
const GRID_FRAGMENT = `#version 300 es
precision highp float;
in vec2 at;
uniform vec4 colour, square;
uniform float spacing;
out vec4 shown;
float lines(float size) {
  vec2 x = at / size;
  vec2 near = abs(fract(x - 0.5) - 0.5) / max(fwidth(x), 1e-6);
  float dense = max(fwidth(x).x, fwidth(x).y);
  return (1.0 - min(min(near.x, near.y), 1.0)) * (1.0 - smoothstep(0.2, 0.6, dense));
}
void main() {
  float strength = max(0.45 * lines(spacing), lines(5.0 * spacing));
  float away = length(at - square.xy) / square.w;
  shown = vec4(colour.rgb, colour.a * strength * (1.0 - smoothstep(0.25, 0.95, away)));
}`;
