// SPDX-License-Identifier: Apache-2.0
// What runs on the graphics: balls that are squares with the look and the depth of a ball, and lines.
const place = `#version 300 es
precision highp float;
in float px, py, pz, tint, hide, size;
uniform vec3 A, B, C;
uniform mat4 view, project;
vec4 seen() { return view * vec4((vec3(px, py, pz) - C) * A + B, 1.0); }
`;

fp3.ballVertex = place + `
in vec2 corner;
uniform vec2 pixels;
uniform float radius, least;
uniform int picked;
flat out vec3 centre;
flat out float ballRadius, ballTint;
flat out int isPicked;
out vec2 at;
void main() {
  vec4 v = seen();
  float pixel = (project * v).w * 2.0 / (project[1][1] * pixels.y);
  isPicked = gl_InstanceID == picked ? 1 : 0;
  ballRadius = max(radius * size, (least + 2.5 * float(isPicked)) * pixel);
  ballTint = tint;
  centre = v.xyz;
  at = corner;
  gl_Position = hide > 0.5 ? vec4(2.0, 2.0, 2.0, 1.0) : project * (v + vec4(corner * ballRadius, 0.0, 0.0));
}`;

const colour = `#version 300 es
precision highp float;
uniform vec3 stops[6];
uniform vec3 plain, mark;
vec3 tinted(float t) {
  if (t < -1.5) return vec3(0.5);
  if (t < 0.0) return plain;
  float s = clamp(t, 0.0, 1.0) * 5.0;
  int i = min(int(s), 4);
  return mix(stops[i], stops[i + 1], s - float(i));
}
out vec4 pixel;
`;

fp3.ballFragment = colour + `
uniform mat4 project;
flat in vec3 centre;
flat in float ballRadius, ballTint;
flat in int isPicked;
in vec2 at;
void main() {
  float d = dot(at, at);
  if (d > 1.0) discard;
  vec3 normal = vec3(at, sqrt(1.0 - d));
  float light = 0.5 + 0.5 * max(dot(normal, normalize(vec3(-0.35, 0.6, 0.72))), 0.0);
  vec4 clip = project * vec4(centre + normal * ballRadius, 1.0);
  gl_FragDepth = clamp(clip.z / clip.w * 0.5 + 0.5, 0.0, 1.0);
  pixel = vec4(isPicked == 1 && d > 0.5 ? mark : tinted(ballTint) * light, 1.0);
}`;

fp3.lineVertex = place + `
out float lineTint, lineHide;
void main() {
  lineTint = tint;
  lineHide = hide;
  gl_Position = project * seen();
}`;

fp3.lineFragment = colour + `
uniform vec4 ink;
uniform float mixed;
in float lineTint, lineHide;
void main() {
  if (lineHide > 0.0) discard;
  pixel = vec4(mix(ink.rgb, tinted(lineTint), lineTint < 0.0 ? 0.0 : mixed), ink.a);
}`;

// From dark to bright, so that it can be told in grey, too.
fp3.stops = [[52, 41, 122], [38, 98, 168], [22, 146, 156], [74, 184, 112], [170, 205, 66], [250, 218, 72]];
