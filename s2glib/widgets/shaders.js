// Shaders of the body player, the little matrix work they need, and nothing else.
//
// SKIN moves every vertex once a frame: it adds the face, then blends the vertex's bones (three rows
// each). What it writes is drawn twice, as shadow and as picture.

const MORPH_COLUMNS = 1024; // width of the texture that holds the face's directions
const MOST_FEET = 8; // joints that touch the ground with a soft shadow

const SKIN = `#version 300 es
precision highp float;
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 bones;
layout(location = 3) in vec4 weights;
layout(location = 4) in float morph;
uniform vec4 skin[3 * JOINTS];
uniform float curves[CURVES];
uniform highp sampler2D morphs;
uniform vec3 place;
out vec3 world;
out vec3 facing;

vec3 direction(int curve, int part) {
  int row = (int(morph) / ${MORPH_COLUMNS}) * 2 * CURVES + 2 * curve + part;
  return texelFetch(morphs, ivec2(int(morph) % ${MORPH_COLUMNS}, row), 0).xyz;
}

void main() {
  vec3 p = position, n = normal;
  if (morph >= 0.) for (int k = 0; k < CURVES; k++) if (curves[k] != 0.) {
    p += curves[k] * direction(k, 0);
    n += curves[k] * direction(k, 1);
  }
  vec4 x = vec4(0), y = vec4(0), z = vec4(0);
  for (int i = 0; i < 4; i++) {
    int bone = 3 * int(bones[i]);
    x += weights[i] * skin[bone];
    y += weights[i] * skin[bone + 1];
    z += weights[i] * skin[bone + 2];
  }
  vec4 h = vec4(p, 1.);
  world = vec3(dot(x, h), dot(y, h), dot(z, h)) + place;
  facing = normalize(vec3(dot(x.xyz, n), dot(y.xyz, n), dot(z.xyz, n)));
}`;

const BODY_VS = `#version 300 es
layout(location = 0) in vec3 world;
layout(location = 1) in vec3 facing;
layout(location = 2) in vec3 color;
uniform mat4 camera;
uniform mat4 sun;
out vec3 at;
out vec3 normal;
out vec3 tint;
out vec4 lit;
void main() {
  at = world;
  normal = facing;
  tint = pow(color, vec3(2.2));
  lit = sun * vec4(world, 1.);
  gl_Position = camera * vec4(world, 1.);
}`;
const CASTER_VS = `#version 300 es
layout(location = 0) in vec3 world;
uniform mat4 sun;
void main() { gl_Position = sun * vec4(world, 1.); }`;

const LIGHT = `#version 300 es
precision highp float;
uniform highp sampler2DShadow shadow;
uniform vec2 canvasSize;
out vec4 paint;

float sunlight(vec4 lit, float blur, float bias) {
  vec3 at = lit.xyz / lit.w * .5 + .5;
  float turn = 6.2832 * fract(52.9829 * fract(dot(gl_FragCoord.xy, vec2(.06711056, .00583715))));
  float sum = 0.;
  for (int i = 0; i < 8; i++) {
    float r = sqrt((float(i) + .5) / 8.), a = turn + 2.39996 * float(i);
    sum += texture(shadow, vec3(at.xy + blur * r * vec2(cos(a), sin(a)), at.z - bias));
  }
  return sum / 8.;
}

vec3 backdrop() {
  vec2 uv = gl_FragCoord.xy / canvasSize;
  vec3 low = vec3(.86, .72, .60), high = vec3(.985, .94, .875);
  float glow = exp(-2.2 * dot(uv - vec2(.5, .62), uv - vec2(.5, .62)));
  return mix(low, high, clamp(.25 * uv.y + .8 * glow, 0., 1.));
}

vec3 screen(vec3 light) { return pow(clamp(light, 0., 1.), vec3(1. / 2.2)); }
`;

const BODY = `${LIGHT}
in vec3 at;
in vec3 normal;
in vec3 tint;
in vec4 lit;
uniform vec3 eye;
uniform vec3 toSun;
void main() {
  vec3 n = normalize(normal), v = normalize(eye - at);
  if (dot(n, v) < -.2) n = -n;
  float key = clamp((dot(n, toSun) + .25) / 1.25, 0., 1.);
  key *= mix(.25, 1., sunlight(lit, .004, .004));
  vec3 fill = mix(vec3(.30, .22, .17), vec3(.50, .49, .52), .5 + .5 * n.y);
  float rim = pow(1. - clamp(dot(n, v), 0., 1.), 3.5) * clamp(.6 + .4 * n.y, 0., 1.);
  float gloss = pow(clamp(dot(n, normalize(v + toSun)), 0., 1.), 24.);
  vec3 light = tint * (fill + key * vec3(.82, .72, .58)) + vec3(.16, .13, .10) * rim;
  paint = vec4(screen(light + .05 * gloss * key), 1.);
}`;

const BACKDROP_VS = `#version 300 es
layout(location = 0) in vec2 corner;
void main() { gl_Position = vec4(corner, .9999, 1.); }`;
const BACKDROP = `${LIGHT}
void main() { paint = vec4(backdrop(), 1.); }`;

const GROUND_VS = `#version 300 es
layout(location = 0) in vec2 corner;
uniform mat4 camera;
uniform mat4 sun;
uniform float floorHeight;
out vec3 world;
out vec4 lit;
void main() {
  world = vec3(8. * corner.x, floorHeight, 8. * corner.y);
  lit = sun * vec4(world, 1.);
  gl_Position = camera * vec4(world, 1.);
}`;
const GROUND = `${LIGHT}
in vec3 world;
in vec4 lit;
uniform vec3 feet[${MOST_FEET}];
uniform int feetCount;
float line(vec2 p) {
  vec2 d = abs(fract(p * 2. - .5) - .5) / fwidth(p * 2.);
  return 1. - clamp(min(d.x, d.y), 0., 1.);
}
void main() {
  float away = length(world.xz);
  float here = 1. - smoothstep(1.2, 4.5, away);
  float contact = 1.;
  if (here > 0.) for (int i = 0; i < feetCount; i++) {
    vec2 d = world.xz - feet[i].xz;
    float r = .09 + .9 * max(feet[i].y - world.y - .05, 0.);
    contact *= 1. - .38 * exp(-dot(d, d) / (2. * r * r));
  }
  float sunny = here > 0. ? mix(1., mix(.62, 1., sunlight(lit, .014, .002)), here) : 1.;
  vec3 ground = backdrop() * mix(1., .93, here) * (1. - .07 * line(world.xz) * here);
  paint = vec4(ground * sunny * mix(1., contact, here), 1.);
}`;

const NOTHING = `#version 300 es
precision highp float;
void main() {}`;

function normalize(v) {
  const length = Math.hypot(...v) || 1;
  return v.map((x) => x / length);
}
function cross(a, b) {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}
function dot(a, b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/** Product of two 4 x 4 matrices, column after column as GLSL wants them. */
function times(A, B) {
  const out = new Float32Array(16);
  for (let c = 0; c < 4; c++)
    for (let r = 0; r < 4; r++)
      for (let k = 0; k < 4; k++) out[4 * c + r] += A[4 * k + r] * B[4 * c + k];
  return out;
}
function lookAt(eye, target) {
  const z = normalize(eye.map((e, i) => e - target[i]));
  const x = normalize(cross([0, 1, 0], z));
  const y = cross(z, x);
  const rows = [x, y, z];
  const columns = [0, 1, 2].flatMap((i) => [...rows.map((row) => row[i]), 0]);
  return [...columns, -dot(x, eye), -dot(y, eye), -dot(z, eye), 1];
}
function perspective(field, aspect, near, far) {
  const f = 1 / Math.tan(field / 2);
  const depth = near - far;
  return [f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / depth, -1, 0, 0, (2 * far * near) / depth, 0];
}
function orthographic(halfWidth, halfHeight, depth) {
  return [1 / halfWidth, 0, 0, 0, 0, 1 / halfHeight, 0, 0, 0, 0, -2 / depth, 0, 0, 0, -1, 1];
}

/** One shader program with its uniforms by name. */
class Program {
  constructor(gl, vertex, fragment, feedback = []) {
    this.gl = gl;
    this.handle = gl.createProgram();
    for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost())
        throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(this.handle, shader);
    }
    if (feedback.length) gl.transformFeedbackVaryings(this.handle, feedback, gl.INTERLEAVED_ATTRIBS);
    gl.linkProgram(this.handle);
    this.places = {};
  }
  /** Make it current and set the uniforms it has, each given as [kind of gl.uniform*, value]. */
  use(uniforms) {
    const { gl } = this;
    gl.useProgram(this.handle);
    for (const [name, [kind, value]] of Object.entries(uniforms)) {
      if (!(name in this.places)) this.places[name] = gl.getUniformLocation(this.handle, name);
      const place = this.places[name];
      if (kind === "Matrix4fv") gl.uniformMatrix4fv(place, false, value);
      else gl[`uniform${kind}`](place, value);
    }
  }
}
