// The sheet: a picture on a mesh that the graphics card bends, with the source's grid lines on it.

const CELLS = 48; // along each side of the mesh
const SHEET_VS = `#version 300 es
in vec2 place; in vec2 shown; out vec2 source;
void main() { source = shown; gl_Position = vec4(place.x, -place.y, 0., 1.); }`;
const SHEET_FS = `#version 300 es
precision highp float;
uniform sampler2D picture; in vec2 source; out vec4 color;
void main() {
  vec2 size = vec2(textureSize(picture, 0));
  vec3 paint = texture(picture, ((source + 1.) / 2. * (size - 1.) + .5) / size).rgb;
  vec2 beyond = step(1., abs(source)) * step(.5, fract((gl_FragCoord.x + gl_FragCoord.y) / 16.));
  if (any(greaterThan(abs(source), vec2(1.)))) paint = mix(vec3(.965, .94, .9), vec3(.9, .86, .8), max(beyond.x, beyond.y));
  vec2 steps = 4. * source;
  vec2 away = abs(fract(steps - .5) - .5) / fwidth(steps);
  float line = 1. - smoothstep(.4, 1.4, min(away.x, away.y));
  color = vec4(mix(paint, vec3(.1), .55 * line), 1.);
}`;

class Sheet {
  constructor(canvas, picture) {
    const gl = canvas.getContext("webgl2", { antialias: false, preserveDrawingBuffer: true, alpha: false });
    if (!gl) throw new Error("This browser offers no WebGL2, which the picture needs.");
    Object.assign(this, { canvas, gl });
    const program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, SHEET_VS], [gl.FRAGMENT_SHADER, SHEET_FS]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) throw new Error(gl.getProgramInfoLog(program));
    gl.useProgram(program);
    this.makeMesh(program);
    this.upload(picture);
  }

  makeMesh(program) {
    const { gl } = this;
    const along = Array.from({ length: CELLS + 1 }, (_, k) => (2 * k) / CELLS - 1);
    this.places = along.flatMap((y) => along.map((x) => [x, y]));
    const corners = [0, 1, CELLS + 1, CELLS + 1, 1, CELLS + 2];
    const cells = Array.from({ length: CELLS * CELLS }, (_, k) => Math.floor(k / CELLS) * (CELLS + 1) + (k % CELLS));
    const triangles = new Uint16Array(cells.flatMap((first) => corners.map((corner) => first + corner)));
    this.count = triangles.length;
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, triangles, gl.STATIC_DRAW);
    for (const name of ["place", "shown"]) { // "shown" is left bound: every drawing fills it anew
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(this.places.flat()), gl.DYNAMIC_DRAW);
      const slot = gl.getAttribLocation(program, name);
      gl.enableVertexAttribArray(slot);
      gl.vertexAttribPointer(slot, 2, gl.FLOAT, false, 0, 0);
    }
  }
  upload(picture) {
    const { gl } = this;
    gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, picture);
    for (const side of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, side, gl.CLAMP_TO_EDGE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
  }

  /** Show, at every point of the mesh, the point of the picture that `lookUp` names. */
  draw(lookUp) {
    const { gl, canvas } = this;
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.bufferSubData(gl.ARRAY_BUFFER, 0, new Float32Array(this.places.flatMap(lookUp)));
    gl.drawElements(gl.TRIANGLES, this.count, gl.UNSIGNED_SHORT, 0);
  }
  close() {
    this.gl.getExtension("WEBGL_lose_context")?.loseContext();
  }
}
