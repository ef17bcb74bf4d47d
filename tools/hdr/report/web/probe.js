// The finished probe: from inside, from outside, and on objects that it lights. WebGL2, drawn when something changes.
'use strict';
(() => {
  const { load, signed } = hdrReport;
  const kLeastHalfPixels = 8;

  class Gpu {
    constructor(canvas) {
      const gl = this.gl = canvas.getContext('webgl2', { antialias: false, alpha: false, preserveDrawingBuffer: true });
      if (!gl) throw new Error('it has no WebGL2');
      if (!gl.getExtension('EXT_color_buffer_float') && !gl.getExtension('EXT_color_buffer_half_float')) {
        throw new Error('it cannot draw into halves');
      }
      gl.getExtension('OES_texture_float_linear');
      const buffer = gl.createBuffer();
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array([-1, -1, 3, -1, -1, 3]), gl.STATIC_DRAW);
      gl.enableVertexAttribArray(0);
      gl.vertexAttribPointer(0, 2, gl.FLOAT, false, 0, 0);
    }

    program(fragment) {
      const gl = this.gl, program = gl.createProgram();
      for (const [type, source] of [[gl.VERTEX_SHADER, hdrShaders.vertex], [gl.FRAGMENT_SHADER, fragment]]) {
        const shader = gl.createShader(type);
        gl.shaderSource(shader, source);
        gl.compileShader(shader);
        if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
        gl.attachShader(program, shader);
      }
      gl.bindAttribLocation(program, 0, 'corner');
      gl.linkProgram(program);
      if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
      const places = {}, count = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS);
      for (let k = 0; k < count; ++k) {
        const name = gl.getActiveUniform(program, k).name;
        places[name.replace('[0]', '')] = gl.getUniformLocation(program, name);
      }
      return { program, places };
    }

    // Halves of three (or two) channels as a texture, or an array of them, four channels each.
    texture(part, around, mips) {
      const gl = this.gl, target = part.layers > 1 ? gl.TEXTURE_2D_ARRAY : gl.TEXTURE_2D, kOne = 0x3c00;
      const pixels = part.width * part.height * part.layers, data = new Uint16Array(4 * pixels).fill(kOne);
      for (let k = 0; k < pixels; ++k) {
        for (let c = 0; c < part.channels; ++c) data[4 * k + c] = part.data[part.channels * k + c];
      }
      const texture = gl.createTexture();
      gl.bindTexture(target, texture);
      if (part.layers > 1) {
        gl.texImage3D(target, 0, gl.RGBA16F, part.width, part.height, part.layers, 0, gl.RGBA, gl.HALF_FLOAT, data);
      } else {
        gl.texImage2D(target, 0, gl.RGBA16F, part.width, part.height, 0, gl.RGBA, gl.HALF_FLOAT, data);
      }
      if (mips) gl.generateMipmap(target);
      gl.texParameteri(target, gl.TEXTURE_MIN_FILTER, mips ? gl.LINEAR_MIPMAP_LINEAR : gl.LINEAR);
      gl.texParameteri(target, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
      gl.texParameteri(target, gl.TEXTURE_WRAP_S, around ? gl.REPEAT : gl.CLAMP_TO_EDGE);
      gl.texParameteri(target, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
      return { target, texture };
    }

    // Something to draw into.
    surface(width, height) {
      const gl = this.gl, texture = gl.createTexture(), frame = gl.createFramebuffer();
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA16F, width, height);
      for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, gl.LINEAR);
      for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, name, gl.CLAMP_TO_EDGE);
      gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
      gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
      return { target: gl.TEXTURE_2D, texture, frame, width, height };
    }

    free(surface) {
      this.gl.deleteTexture(surface.texture);
      this.gl.deleteFramebuffer(surface.frame);
    }

    // One triangle over all of `to` (null: the screen); textures and numbers by the names of their uniforms.
    draw(shader, to, textures, set, add = false) {
      const gl = this.gl;
      gl.bindFramebuffer(gl.FRAMEBUFFER, to ? to.frame : null);
      gl.viewport(0, 0, to ? to.width : gl.drawingBufferWidth, to ? to.height : gl.drawingBufferHeight);
      gl.useProgram(shader.program);
      Object.entries(textures).forEach(([name, t], unit) => {
        gl.activeTexture(gl.TEXTURE0 + unit);
        gl.bindTexture(t.target, t.texture);
        gl.uniform1i(shader.places[name], unit);
      });
      set(gl, shader.places);
      if (add) { gl.enable(gl.BLEND); gl.blendFunc(gl.ONE, gl.ONE); }
      gl.drawArrays(gl.TRIANGLES, 0, 3);
      gl.disable(gl.BLEND);
    }
  }

  class Viewer {
    constructor(root, probe, levels, table) {
      this.root = root;
      this.canvas = root.querySelector('canvas');
      this.gpu = new Gpu(this.canvas);
      this.shaders = {};
      for (const name of ['scene', 'bright', 'resample', 'streak', 'display']) {
        this.shaders[name] = this.gpu.program(hdrShaders[name]);
      }
      this.probe = this.gpu.texture(probe, true, true);
      this.levels = this.gpu.texture(levels, true, false);
      this.table = this.gpu.texture(table, false, false);
      this.scales = [probe.scale, levels.scale];
      this.numbers = (name) => root.dataset[name].split(' ').map(Number);
      this.roughness = this.numbers('roughness');
      this.irradiance = this.numbers('irradiance');
      // Inside, the way the photographer looks at the ball; else from the side: a ball is blind behind itself.
      this.turns = [[0, 0], [0.5, 0.25], [1.25, 0.12]];
      this.zoom = 0;
      this.surfaces = [];
      this.listen();
      this.draw();
      root.dataset.ready = 'yes';
    }

    control(name) { return this.root.querySelector('.' + name); }

    listen() {
      this.root.addEventListener('input', () => this.later());
      const fingers = new Map();
      const spread = () => {
        const [a, b] = [...fingers.values()];
        return Math.hypot(a[0] - b[0], a[1] - b[1]);
      };
      this.canvas.addEventListener('pointerdown', (event) => {
        fingers.set(event.pointerId, [event.clientX, event.clientY]);
        this.canvas.setPointerCapture(event.pointerId);
        this.canvas.focus();
      });
      for (const name of ['pointerup', 'pointercancel']) {
        this.canvas.addEventListener(name, (event) => fingers.delete(event.pointerId));
      }
      this.canvas.addEventListener('pointermove', (event) => {
        const before = fingers.get(event.pointerId);
        if (!before) return;
        const two = fingers.size === 2, from = two ? spread() : 0;
        fingers.set(event.pointerId, [event.clientX, event.clientY]);
        if (two) this.nearer(Math.log2(spread() / from));
        else this.turned(event.clientX - before[0], event.clientY - before[1]);
      });
      this.canvas.addEventListener('wheel', (event) => {
        if (document.activeElement !== this.canvas) return;   // a page that scrolls past keeps scrolling
        event.preventDefault();
        this.nearer(-event.deltaY / 500);
      }, { passive: false });
      this.canvas.addEventListener('keydown', (event) => {
        const step = { ArrowLeft: [20, 0], ArrowRight: [-20, 0], ArrowUp: [0, 20], ArrowDown: [0, -20] }[event.key];
        if (step) this.turned(...step);
        else if (event.key === '+') this.nearer(0.2);
        else if (event.key === '-') this.nearer(-0.2);
        else return;
        event.preventDefault();
      });
      new ResizeObserver(() => this.later()).observe(this.canvas);
    }

    turned(dx, dy) {
      const view = Number(this.control('view').value), turn = this.turns[view];
      // Inside, what is under the pointer stays there; outside, a drag over the height is two thirds of a turn.
      const radians = (view === 0 ? 1.3 * 2 ** -this.zoom : 4) / this.canvas.clientHeight;
      turn[0] += radians * dx;
      turn[1] = Math.min(1.55, Math.max(-1.55, turn[1] + radians * dy));
      this.later();
    }

    nearer(octaves) {
      this.zoom = Math.min(3, Math.max(-1, this.zoom + octaves));
      this.later();
    }

    later() {
      if (this.waiting) return;
      this.waiting = true;
      requestAnimationFrame(() => { this.waiting = false; this.draw(); });
    }

    // Right, up, forward. Inside, a drag moves the picture with the pointer; outside, it turns what is looked at.
    camera(view) {
      const [yaw, pitch] = this.turns[view], c = Math.cos, s = Math.sin, p = pitch;
      const forward = view === 0 ? [s(yaw) * c(p), s(p), c(yaw) * c(p)] : [s(yaw) * c(p), -s(p), -c(yaw) * c(p)];
      const flat = Math.hypot(forward[0], forward[2]);
      const right = [-forward[2] / flat, 0, forward[0] / flat];
      const up = [right[1] * forward[2] - right[2] * forward[1], right[2] * forward[0] - right[0] * forward[2],
                  right[0] * forward[1] - right[1] * forward[0]];
      return [...right, ...up, ...forward];
    }

    resize() {
      const ratio = Math.min(window.devicePixelRatio || 1, 2);
      const width = Math.max(16, Math.round(this.canvas.clientWidth * ratio));
      const height = Math.max(16, Math.round(this.canvas.clientHeight * ratio));
      if (this.surfaces.length && this.canvas.width === width && this.canvas.height === height) return;
      this.surfaces.forEach((surface) => this.gpu.free(surface));
      this.canvas.width = width;
      this.canvas.height = height;
      this.surfaces = [this.gpu.surface(width, height)];
      let [w, h] = [width, height];
      for (let k = 0; k < 7 && Math.min(w, h) > 2 * kLeastHalfPixels; ++k) {
        [w, h] = [w >> 1, h >> 1];
        this.surfaces.push(this.gpu.surface(w, h));
      }
      const quarter = this.surfaces[Math.min(2, this.surfaces.length - 1)];
      this.streaks = [0, 1, 2].map(() => this.gpu.surface(quarter.width, quarter.height));
      this.surfaces.push(...this.streaks);
      this.chain = this.surfaces.slice(1, -3);
    }

    draw() {
      this.resize();
      const view = Number(this.control('view').value), ev = Number(this.control('exposure').value);
      const glare = Number(this.control('glare').value);
      this.control('exposure-value').textContent = signed(ev) + ' stops';
      const aspect = this.canvas.width / this.canvas.height;
      const near = 2 ** -this.zoom, extent = view === 0 ? 0.7 * near : view === 1 ? 0.36 * near : 0.36 * near;
      const fit = view === 2 && aspect < 2 ? 2 / aspect : view === 1 && aspect < 1 ? 1 / aspect : 1;
      const scene = this.surfaces[0];
      this.gpu.draw(this.shaders.scene, scene, { probe: this.probe, levels: this.levels, table: this.table }, (gl, at) => {
        gl.uniform1f(at.probe_scale, this.scales[0]);
        gl.uniform1f(at.level_scale, this.scales[1]);
        gl.uniform1fv(at.roughness_of, this.roughness);
        gl.uniform1i(at.level_count, this.roughness.length);
        gl.uniformMatrix4fv(at.irradiance, false, this.irradiance);
        gl.uniformMatrix3fv(at.camera, false, this.camera(view));
        gl.uniform2f(at.extent, extent * fit * aspect, extent * fit);
        gl.uniform1f(at.distance_, view === 0 ? 0 : view === 1 ? 3.4 : 7);
        gl.uniform1i(at.view, view);
        gl.uniform1f(at.roughness, Number(this.control('roughness').value));
        gl.uniform1f(at.gain, 2 ** ev);
      });
      if (glare > 0) this.drawGlare(scene);
      this.gpu.draw(this.shaders.display, null, { source: scene, halo: this.chain[0], star: this.streaks[2] }, (gl, at) => {
        gl.uniform1f(at.glare, glare);
        gl.uniform1i(at.tone, this.control('tone').value === 'filmic' ? 0 : 1);
      });
    }

    // Halos: down by halves and up again, each size adding its own blur. Streaks: four rays of what is bright.
    drawGlare(scene) {
      const { bright, resample, streak } = this.shaders, chain = this.chain;
      const by = (surface, reach) => (gl, at) => gl.uniform2f(at.step_, reach / surface.width, reach / surface.height);
      this.gpu.draw(bright, chain[0], { source: scene }, () => {});
      for (let k = 1; k < chain.length; ++k) {
        this.gpu.draw(resample, chain[k], { source: chain[k - 1] }, by(chain[k - 1], 1));
      }
      this.drawStar(chain[Math.min(1, chain.length - 1)], streak);
      for (let k = chain.length - 1; k > 0; --k) {
        this.gpu.draw(resample, chain[k - 1], { source: chain[k] }, by(chain[k], 1), true);
      }
    }

    drawStar(source, streak) {
      const gl = this.gpu.gl, [one, two, sum] = this.streaks;
      gl.bindFramebuffer(gl.FRAMEBUFFER, sum.frame);
      gl.clearColor(0, 0, 0, 1);
      gl.clear(gl.COLOR_BUFFER_BIT);
      for (const [dx, dy] of [[1, 0.35], [-1, -0.35], [-0.35, 1], [0.35, -1]]) {
        let from = source;
        for (const [to, reach] of [[one, 1], [two, 4], [sum, 16]]) {
          this.gpu.draw(streak, to, { source: from }, (g, at) => {
            g.uniform2f(at.step_, reach * dx / to.width, reach * dy / to.height);
            g.uniform1f(at.fade, 0.93 ** reach);
          }, to === sum);
          from = to;
        }
      }
    }
  }

  const start = async (root) => {
    try {
      const parts = await Promise.all(['probe', 'levels', 'table'].map((name) => load(root.dataset[name])));
      root.viewer = new Viewer(root, ...parts);
    } catch (error) {
      root.querySelector('.readout').textContent = 'This browser cannot show the sphere: ' + error.message;
      root.dataset.ready = 'no';
    }
  };
  for (const root of document.querySelectorAll('.viewer')) start(root);
})();
