// Under the pointer: where it is on the axes, and what each line has there. The numbers come from the drawing itself.
'use strict';
(() => {
  const scaleOf = (text) => {
    const [kind, ...rest] = text.split(' ');
    const [low, high, from, to] = rest.map(Number);
    const log = kind === 'log';
    return (at) => {
      const share = (at - from) / (to - from);
      return log ? low * Math.pow(high / low, share) : low + share * (high - low);
    };
  };
  const shown = (v) => Number(v.toPrecision(4)).toString().replace('-', '\u2212');

  // The drawing's y of a path of straight lines at x; null outside of it.
  const heightAt = (path, x) => {
    if (!path.corners) {
      path.corners = path.getAttribute('d').match(/[ML][^MLZ]+/g).map((part) =>
        [part[0], ...part.slice(1).trim().split(/\s+/).map(Number)]);
    }
    const c = path.corners;
    for (let k = 1; k < c.length; ++k) {
      if (c[k][0] === 'M') continue;
      const [x0, x1] = [c[k - 1][1], c[k][1]];
      if (x < Math.min(x0, x1) || x > Math.max(x0, x1) || x0 === x1) continue;
      return c[k - 1][2] + (x - x0) / (x1 - x0) * (c[k][2] - c[k - 1][2]);
    }
    return null;
  };

  for (const svg of document.querySelectorAll('svg.plot')) {
    const x = scaleOf(svg.dataset.x), y = scaleOf(svg.dataset.y);
    const frame = svg.querySelector('.frame'), output = svg.parentNode.querySelector('.readout');
    const box = ['x', 'y', 'width', 'height'].map((name) => Number(frame.getAttribute(name)));
    const cursor = document.createElementNS('http://www.w3.org/2000/svg', 'line');
    cursor.setAttribute('class', 'cursor');
    cursor.setAttribute('y1', box[1]);
    cursor.setAttribute('y2', box[1] + box[3]);
    cursor.style.display = 'none';
    svg.append(cursor);
    const lines = [...svg.querySelectorAll('.marks > path.line')];
    const leave = () => { cursor.style.display = 'none'; output.textContent = ''; };
    svg.addEventListener('pointerleave', leave);
    svg.addEventListener('pointermove', (event) => {
      const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
      if (at.x < box[0] || at.x > box[0] + box[2] || at.y < box[1] || at.y > box[1] + box[3]) return leave();
      cursor.style.display = '';
      cursor.setAttribute('x1', at.x);
      cursor.setAttribute('x2', at.x);
      const note = event.target.querySelector && event.target.closest('.marks') && event.target.querySelector('title');
      if (note) { output.textContent = note.textContent; return; }
      const parts = [`(${shown(x(at.x))}, ${shown(y(at.y))})`];
      for (const line of lines) {
        const height = heightAt(line, at.x);
        if (height !== null && line.dataset.name) parts.push(`${line.dataset.name} ${shown(y(height))}`);
      }
      output.textContent = parts.join('; ');
    });
  }
})();
