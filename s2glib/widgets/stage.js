// The stage: one canvas on which one or more bodies stand in warm light.
//
// The mesh goes to the GPU once. A frame costs 55 bones and a few face curves: turns are blended
// between two frames, walked down the tree, and handed to the shader that moves the vertices.

const SHADOW_SIZE = 1024;
const SPACING = 1.15; // metres between bodies that stand side by side
const FIELD = 0.42; // vertical field of view, radians
const SUN = normalize([0.42, 0.85, 0.62]);
const FRAMINGS = {
  upper: { middle: 0.755, half: 0.335, wide: 0.62 }, // shares of the height, but `wide` in metres
  whole: { middle: 0.48, half: 0.6, wide: 0.75 },
};

/** How far right a point lies in the picture, -1 to 1. */
function along(matrix, [x, y, z]) {
  const row = (k) => matrix[k] * x + matrix[4 + k] * y + matrix[8 + k] * z + matrix[12 + k];
  return row(0) / row(3);
}

/** Smooth edges, but not where the processor must draw: they would halve the frame rate. */
function openWebGL(canvas) {
  const probe = document.createElement("canvas").getContext("webgl2");
  const info = probe?.getExtension("WEBGL_debug_renderer_info");
  const drawnBy = info ? probe.getParameter(info.UNMASKED_RENDERER_WEBGL) : "";
  probe?.getExtension("WEBGL_lose_context")?.loseContext();
  const antialias = !/swiftshader|llvmpipe|basic render/i.test(drawnBy);
  return canvas.getContext("webgl2", { antialias, preserveDrawingBuffer: true, alpha: false });
}

class Stage {
  constructor(canvas, mesh) {
    const gl = openWebGL(canvas);
    if (!gl) throw new Error("This browser offers no WebGL2, which the 3-D body needs.");
    Object.assign(this, { canvas, gl, mesh, actors: [] });
    const curves = Math.max(mesh.curves, 1);
    const skin = SKIN.replaceAll("JOINTS", mesh.parents.length).replaceAll("CURVES", curves);
    this.skin = new Program(gl, skin, NOTHING, ["world", "facing"]);
    this.body = new Program(gl, BODY_VS, BODY);
    this.caster = new Program(gl, CASTER_VS, NOTHING);
    this.ground = new Program(gl, GROUND_VS, GROUND);
    this.backdrop = new Program(gl, BACKDROP_VS, BACKDROP);
    this.uploadMesh();
    this.uploadMorphs(curves);
    this.makeShadow();
    gl.enable(gl.DEPTH_TEST);
  }

  uploadMesh() {
    const { gl, mesh } = this;
    const fill = (target, data) => {
      const buffer = gl.createBuffer();
      gl.bindBuffer(target, buffer);
      gl.bufferData(target, data, gl.STATIC_DRAW);
      return buffer;
    };
    const store = (data) => fill(gl.ARRAY_BUFFER, data);
    this.rest = this.layout([
      [store(mesh.vertices), 3, gl.FLOAT, false, 0, 0],
      [store(mesh.normals), 4, gl.BYTE, true, 0, 0],
      [store(mesh.bones), 4, gl.UNSIGNED_BYTE, false, 0, 0],
      [store(mesh.weights), 4, gl.UNSIGNED_SHORT, true, 0, 0],
      [store(mesh.morph), 1, gl.FLOAT, false, 0, 0],
    ]);
    this.sheet = this.layout([[store(new Float32Array([-1, -1, 1, -1, -1, 1, 1, 1])), 2, gl.FLOAT, false, 0, 0]]);
    this.colors = store(mesh.colors);
    this.faces = fill(gl.ELEMENT_ARRAY_BUFFER, mesh.faces);
  }

  /** A vertex array: one attribute for each [buffer, width, kind, scaled, stride, offset]. */
  layout(attributes) {
    const { gl } = this;
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    attributes.forEach(([buffer, ...format], slot) => {
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.enableVertexAttribArray(slot);
      gl.vertexAttribPointer(slot, ...format);
    });
    gl.bindBuffer(gl.ARRAY_BUFFER, null);
    return array;
  }

  /** Room on the GPU for one posed body: six numbers a vertex, where it is and where it faces. */
  actor(k) {
    const { gl, mesh, colors } = this;
    if (!this.actors[k]) {
      const buffer = gl.createBuffer();
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bufferData(gl.ARRAY_BUFFER, 8 * mesh.vertices.length, gl.DYNAMIC_COPY);
      const surface = this.layout([
        [buffer, 3, gl.FLOAT, false, 24, 0],
        [buffer, 3, gl.FLOAT, false, 24, 12],
        [colors, 4, gl.UNSIGNED_BYTE, true, 0, 0],
      ]);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.faces);
      gl.bindVertexArray(null);
      this.actors[k] = { buffer, surface };
    }
    return this.actors[k];
  }

  /** Pose one body at a time and place; its vertices end in the buffer of actor `k`. */
  pose(k, motion, body, time, place) {
    const { gl, mesh } = this;
    const { skin, curves, places } = poseAt(mesh, motion, body, time);
    const actor = this.actor(k);
    this.skin.use({
      skin: ["4fv", skin],
      curves: ["1fv", curves.length ? curves : [0]],
      place: ["3fv", place],
      morphs: ["1i", 1],
    });
    gl.bindVertexArray(this.rest);
    gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, 0, actor.buffer);
    gl.enable(gl.RASTERIZER_DISCARD);
    gl.beginTransformFeedback(gl.POINTS);
    gl.drawArrays(gl.POINTS, 0, mesh.vertices.length / 3);
    gl.endTransformFeedback();
    gl.disable(gl.RASTERIZER_DISCARD);
    gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, 0, null);
    const feet = mesh.feet.map((joint) => places[joint].map((x, axis) => x + place[axis]));
    return { ...actor, feet, place };
  }

  /** The vertices that the GPU draws, for tests. */
  readVertices(motion, time, body) {
    const { gl, mesh } = this;
    const { buffer } = this.pose(0, motion, body, time, [0, 0, 0]);
    const both = new Float32Array(2 * mesh.vertices.length);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.getBufferSubData(gl.ARRAY_BUFFER, 0, both);
    gl.bindBuffer(gl.ARRAY_BUFFER, null); // a buffer that is bound elsewhere cannot be written
    return both.filter((_, k) => k % 6 < 3);
  }

  /** Directions of the face, one texel a moving vertex: rows are (block, curve, place / normal). */
  uploadMorphs(curves) {
    const { gl, mesh } = this;
    const [count] = mesh.directions.shape;
    const blocks = Math.max(1, Math.ceil(count / MORPH_COLUMNS));
    const texels = new Float32Array(blocks * 2 * curves * MORPH_COLUMNS * 4);
    for (let v = 0; v < count; v++)
      for (let row = 0; row < 2 * curves; row++) {
        const block = Math.floor(v / MORPH_COLUMNS) * 2 * curves + row;
        const from = 3 * (v * 2 * curves + row);
        const scale = row % 2 ? 1 / 4096 : mesh.reach / 32767;
        for (let k = 0; k < 3; k++)
          texels[4 * (block * MORPH_COLUMNS + (v % MORPH_COLUMNS)) + k] = scale * mesh.directions[from + k];
      }
    this.morphs = gl.createTexture();
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, this.morphs);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, MORPH_COLUMNS, blocks * 2 * curves, 0, gl.RGBA, gl.FLOAT, texels);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
  }

  makeShadow() {
    const { gl } = this;
    this.shadow = gl.createFramebuffer();
    this.depth = gl.createTexture();
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.depth);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.DEPTH_COMPONENT24, SHADOW_SIZE, SHADOW_SIZE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE);
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
      gl.texParameteri(gl.TEXTURE_2D, filter, gl.LINEAR);
    for (const wrap of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T])
      gl.texParameteri(gl.TEXTURE_2D, wrap, gl.CLAMP_TO_EDGE);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.shadow);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, this.depth, 0);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }

  /** Eye, matrix and target of a camera {turn, rise, zoom, framing} on `count` bodies. */
  aim(camera, motion, count) {
    const { width, height } = this.canvas;
    const { middle, half, wide } = FRAMINGS[camera.framing];
    const aspect = width / height;
    const halfWidth = wide + (SPACING * (count - 1)) / 2;
    const distance = (Math.max(half * this.mesh.height, halfWidth / aspect) / Math.tan(FIELD / 2)) * camera.zoom;
    const target = [0, motion.floor + middle * this.mesh.height, 0];
    const flat = Math.cos(camera.rise);
    const away = [flat * Math.sin(camera.turn), Math.sin(camera.rise), flat * Math.cos(camera.turn)];
    const eye = target.map((t, k) => t + distance * away[k]);
    const matrix = times(perspective(FIELD, aspect, 0.05, 60), lookAt(eye, target));
    return { eye, matrix };
  }

  /** Draw some of a motion's bodies, from left to right; returns how far right each stands, -1 to 1. */
  draw(motion, time, bodies, camera) {
    const { gl, canvas, mesh } = this;
    const { eye, matrix } = this.aim(camera, motion, bodies.length);
    const middle = [0, motion.floor + 0.45 * mesh.height, 0];
    const reach = [1.1 + (SPACING * (bodies.length - 1)) / 2, 1.2, 8];
    const sun = times(orthographic(...reach), lookAt(middle.map((m, k) => m + 4 * SUN[k]), middle));
    const cast = bodies.map((body, k) =>
      this.pose(k, motion, body, time, [SPACING * (k - (bodies.length - 1) / 2), 0, 0]));
    const scene = {
      camera: ["Matrix4fv", matrix],
      sun: ["Matrix4fv", sun],
      shadow: ["1i", 0],
      canvasSize: ["2fv", [canvas.width, canvas.height]],
      eye: ["3fv", eye],
      toSun: ["3fv", SUN],
    };
    this.castShadow(cast, scene);
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    this.drawRoom(motion, cast, scene);
    this.drawBodies(this.body, cast, scene);
    return cast.map(({ place: [x] }) => along(matrix, [x, middle[1], 0]));
  }

  castShadow(cast, scene) {
    const { gl } = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.shadow);
    gl.viewport(0, 0, SHADOW_SIZE, SHADOW_SIZE);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    this.drawBodies(this.caster, cast, scene);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }

  drawRoom(motion, cast, scene) {
    const { gl } = this;
    const feet = cast.flatMap((actor) => actor.feet).slice(0, MOST_FEET);
    gl.bindVertexArray(this.sheet);
    this.backdrop.use(scene);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    const floor = { floorHeight: ["1f", motion.floor], feet: ["3fv", feet.flat()], feetCount: ["1i", feet.length] };
    this.ground.use({ ...scene, ...floor });
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
  }

  drawBodies(program, cast, scene) {
    const { gl, mesh } = this;
    program.use(scene);
    for (const { surface } of cast) {
      gl.bindVertexArray(surface);
      gl.drawElements(gl.TRIANGLES, mesh.faces.length, gl.UNSIGNED_INT, 0);
    }
  }

  close() {
    this.gl.getExtension("WEBGL_lose_context")?.loseContext();
  }
}
