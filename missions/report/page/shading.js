// Points are drawn as discs, scaled by their spacing, and shaded by depth (eye-dome lighting, C.
// Boucheny, "Visualisation scientifique de grands volumes de donnees", 2009). This makes edges and
// hollows visible without normals.

const point_vertex = `
attribute vec3 colour;
attribute float shot;
uniform float scale, spacing, least, most, first_view, last_view;
varying vec3 shade;
void main() {
  shade = colour;
  vec4 place = modelViewMatrix * vec4(position, 1.0);
  gl_Position = projectionMatrix * place;
  gl_PointSize = clamp(spacing * scale / -place.z, least, most);
  if (shot < first_view || shot > last_view) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}`;

const point_fragment = `
varying vec3 shade;
void main() {
  vec2 off = gl_PointCoord - 0.5;
  if (dot(off, off) > 0.25) discard;
  gl_FragColor = vec4(shade, 1.0);
}`;

const screen_vertex = `
varying vec2 place;
void main() {
  place = position.xy * 0.5 + 0.5;
  gl_Position = vec4(position.xy, 0.0, 1.0);
}`;

const screen_fragment = `
uniform sampler2D picture, depths;
uniform vec2 pixel;
uniform float near, far, strength;
uniform int samples;
uniform vec3 above, below;
varying vec2 place;
float log_depth(vec2 at) {
  float depth = texture2D(depths, at).r;
  return log2(near * far / (far - depth * (far - near)));
}
void main() {
  float depth = texture2D(depths, place).r;
  gl_FragDepthEXT = depth;
  if (depth >= 1.0) {
    gl_FragColor = vec4(mix(below, above, place.y), 1.0);
    return;
  }
  float own = log_depth(place), dark = 0.0;
  for (int i = 0; i < 16; ++i) {
    if (i >= samples) break;
    float angle = 0.785398 * float(i), reach = i < 8 ? 1.0 : 3.2;
    vec2 at = place + pixel * reach * vec2(cos(angle), sin(angle));
    dark += min(max(0.0, own - log_depth(at)), 0.02) / (i < 8 ? 1.0 : 2.0);
  }
  gl_FragColor = vec4(texture2D(picture, place).rgb * exp(-strength * dark / (samples > 8 ? 12.0 : 8.0)), 1.0);
}`;

function point_material(spacing, least) {
  return new THREE.ShaderMaterial({
    vertexShader: point_vertex,
    fragmentShader: point_fragment,
    uniforms: {
      scale: { value: 1 }, spacing: { value: spacing }, least: { value: least }, most: { value: 40 },
      first_view: { value: 0 }, last_view: { value: 65535 },
    },
  });
}

function screen_material() {
  return new THREE.ShaderMaterial({
    vertexShader: screen_vertex,
    fragmentShader: screen_fragment,
    extensions: { fragDepth: true },
    depthFunc: THREE.AlwaysDepth,
    uniforms: {
      picture: { value: null }, depths: { value: null }, pixel: { value: new THREE.Vector2() },
      near: { value: 1 }, far: { value: 2 }, strength: { value: 190 }, samples: { value: 16 },
      above: { value: new THREE.Color(0x1d2b38) }, below: { value: new THREE.Color(0x0c1217) },
    },
  });
}
