// Pictures in linear light: data out of the page, exposure, tone, false colour, masks laid over, values under the pointer.
'use strict';
const hdrReport = (() => {
  const loads = new Map();

  // The bytes of an element, base64 of a deflate stream.
  const bytesOf = async (element) => {
    const text = atob(element.textContent.trim());
    const packed = new Uint8Array(text.length);
    for (let k = 0; k < text.length; ++k) packed[k] = text.charCodeAt(k);
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  };

  // Undoes append_rows() of embed.cpp: planes of high and low bytes, each less the one before it.
  const halvesOf = (bytes, width, rows, channels) => {
    const halves = new Uint16Array(width * rows * channels), samples = width * channels;
    for (let y = 0; y < rows; ++y) {
      for (let c = 0; c < channels; ++c) {
        let high = 0, low = 0;
        for (let x = 0; x < width; ++x) {
          const at = 2 * samples * y + c * width + x;
          high = (high + bytes[at]) & 255;
          low = (low + bytes[at + samples]) & 255;
          halves[samples * y + channels * x + c] = high << 8 | low;
        }
      }
    }
    return halves;
  };

  // {width, height, channels, layers, scale, data}: data are halves or bytes.
  const load = (id) => {
    if (!loads.has(id)) {
      loads.set(id, (async () => {
        const element = document.getElementById(id), d = element.dataset;
        const part = { width: +d.width, height: +d.height, channels: +d.channels, layers: +(d.layers || 1),
                       scale: +(d.scale || 1) };
        const bytes = await bytesOf(element);
        part.data = d.kind === 'half' ? halvesOf(bytes, part.width, part.height * part.layers, part.channels) : bytes;
        return part;
      })());
    }
    return loads.get(id);
  };

  const float32FromHalf = (() => {
    const table = new Float32Array(0x7c00);
    for (let h = 0; h < 0x7c00; ++h) {
      const exponent = h >> 10, mantissa = h & 1023;
      table[h] = exponent ? 2 ** (exponent - 15) * (1 + mantissa / 1024) : 2 ** -24 * mantissa;
    }
    return table;
  })();

  const srgb = (x) => x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055;
  // As libhdr/filter/tonemap.cpp: Hable's curve, an exposure bias of 2, white at 11.2.
  const hable = (x) => (x * (0.15 * x + 0.05) + 0.004) / (x * (0.15 * x + 0.5) + 0.06) - 0.02 / 0.3;
  const filmic = (x) => hable(2 * x) / hable(11.2);
  const codeOf = (x) => Math.round(255 * srgb(Math.min(1, Math.max(0, x))));

  // Viridis at even steps: lightness grows with it, for every eye.
  const viridis = [[68, 1, 84], [71, 44, 122], [59, 81, 139], [44, 113, 142], [33, 144, 141], [39, 173, 129],
                   [92, 200, 99], [170, 220, 50], [253, 231, 37]];
  const falseColour = (share) => {
    const at = Math.min(0.9999, Math.max(0, share)) * (viridis.length - 1), k = Math.floor(at);
    return viridis[k].map((c, i) => Math.round(c + (at - k) * (viridis[k + 1][i] - c)));
  };

  const signed = (v) => (v < 0 ? '\u2212' : '+') + Math.abs(v);
  const shown = (v) => Number(v.toPrecision(3)).toString().replace('-', '\u2212');

  return { load, float32FromHalf, filmic, codeOf, falseColour, signed, shown };
})();

(() => {
  const { load, float32FromHalf, filmic, codeOf, falseColour, signed, shown } = hdrReport;

  class Picture {
    constructor(root, part, masks) {
      this.root = root;
      this.part = part;
      this.masks = masks;
      this.canvas = root.querySelector('canvas');
      this.context = this.canvas.getContext('2d');
      this.canvas.width = part.width;
      this.canvas.height = part.height;
      this.pixels = this.context.createImageData(part.width, part.height);
      this.measureLuminance();
      root.addEventListener('input', () => this.draw());
      this.canvas.addEventListener('pointermove', (event) => this.read(event));
      this.canvas.addEventListener('pointerleave', () => { root.querySelector('.readout').textContent = ''; });
      this.draw();
      root.dataset.ready = 'yes';
    }

    value(k) { return float32FromHalf[this.part.data[k]] * this.part.scale; }

    // log2 of luminance over 18 % grey, and its 0.1 % and 99.9 % quantiles.
    measureLuminance() {
      const count = this.part.width * this.part.height;
      this.stops = new Float32Array(count);
      for (let k = 0; k < count; ++k) {
        const y = 0.2126 * this.value(3 * k) + 0.7152 * this.value(3 * k + 1) + 0.0722 * this.value(3 * k + 2);
        this.stops[k] = y > 0 ? Math.log2(y / 0.18) : -200;
      }
      const sorted = this.stops.filter((s) => s > -200).sort();
      const at = (q) => sorted.length ? sorted[Math.min(sorted.length - 1, Math.floor(q * sorted.length))] : 0;
      this.range = [at(0.001), at(0.999)];
    }

    draw() {
      const ev = Number(this.root.querySelector('.exposure').value);
      this.root.querySelector('.exposure-value').textContent = signed(ev) + ' stops';
      const tone = this.root.querySelector('.tone').value;
      if (tone === 'false') this.drawStops(ev);
      else this.drawTone(ev, tone);
      this.root.querySelector('.stops').hidden = tone !== 'false';
      this.drawMasks();
      this.context.putImageData(this.pixels, 0, 0);
    }

    // Halves are few: one table for all of them, and the pixels are looked up.
    drawTone(ev, tone) {
      const gain = 2 ** ev * this.part.scale, curve = tone === 'filmic' ? filmic : (x) => x;
      const codes = new Uint8ClampedArray(0x7c00);
      for (let h = 0; h < 0x7c00; ++h) codes[h] = codeOf(curve(gain * float32FromHalf[h]));
      const out = this.pixels.data, data = this.part.data;
      for (let k = 0, n = this.stops.length; k < n; ++k) {
        for (let c = 0; c < 3; ++c) out[4 * k + c] = codes[data[3 * k + c]];
        out[4 * k + 3] = 255;
      }
    }

    drawStops(ev) {
      const low = Math.floor(this.range[0] + ev), high = Math.max(low + 1, Math.floor(this.range[1] + ev) + 1);
      const colours = [];
      for (let s = low; s < high; ++s) colours.push(falseColour((s - low + 0.5) / (high - low)));
      const out = this.pixels.data;
      for (let k = 0, n = this.stops.length; k < n; ++k) {
        const bin = Math.floor(this.stops[k] + ev) - low;
        const colour = bin < 0 ? [0, 0, 0] : colours[Math.min(bin, colours.length - 1)];
        for (let c = 0; c < 3; ++c) out[4 * k + c] = colour[c];
        out[4 * k + 3] = 255;
      }
      const legend = this.root.querySelector('.stops');
      legend.replaceChildren(...colours.map((colour, k) => {
        const patch = document.createElement('span');
        patch.style.background = `rgb(${colour})`;
        patch.style.color = k < colours.length / 2 ? '#fff' : '#000';
        patch.textContent = signed(low + k);
        return patch;
      }));
    }

    drawMasks() {
      const out = this.pixels.data;
      for (const mask of this.masks) {
        if (!mask.box.checked) continue;
        for (let k = 0, n = this.stops.length; k < n; ++k) {
          const share = mask.part.data[k] / 255 * 0.85;
          if (share > 0) for (let c = 0; c < 3; ++c) out[4 * k + c] += share * (mask.colour[c] - out[4 * k + c]);
        }
      }
    }

    read(event) {
      const box = this.canvas.getBoundingClientRect();
      const x = Math.floor((event.clientX - box.left) / box.width * this.part.width);
      const y = Math.floor((event.clientY - box.top) / box.height * this.part.height);
      if (x < 0 || y < 0 || x >= this.part.width || y >= this.part.height) return;
      const k = y * this.part.width + x;
      const rgb = [0, 1, 2].map((c) => shown(this.value(3 * k + c))).join(', ');
      const stop = this.stops[k] > -200 ? `, ${signed(Number(this.stops[k].toFixed(1)))} stops from grey` : '';
      this.root.querySelector('.readout').textContent = `radiance ${rgb}${stop}`;
    }
  }

  const start = async (root) => {
    try {
      const masks = await Promise.all([...root.querySelectorAll('input[data-mask]')].map(async (box) => ({
        box, part: await load(box.dataset.mask), colour: box.dataset.colour.split(' ').map(Number) })));
      root.picture = new Picture(root, await load(root.dataset.source), masks);
    } catch (error) {
      root.querySelector('.readout').textContent = 'This browser cannot unpack the picture: ' + error.message;
      root.dataset.ready = 'no';
    }
  };
  for (const root of document.querySelectorAll('.picture')) start(root);
})();
