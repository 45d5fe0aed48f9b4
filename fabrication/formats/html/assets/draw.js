// A part number as three views in first-angle projection, with its overall sizes.

function drawing(number) {
  const lines = number.lines, size = number.size, low = number.low;
  // The longest side lies across, the shortest one is looked along in the front view.
  const order = [0, 1, 2].sort((a, b) => size[b] - size[a]);
  const [across, up, deep] = order;
  const gap = 0.12 * Math.max(size[across], size[up]) + 0.02 * size[across];
  const total = [size[across] + gap + size[deep], size[up] + gap + size[deep]];
  const scale = Math.min(300 / total[0], 260 / total[1]);
  const views = [
    { u: across, v: up, x: 0, y: 0 },
    { u: across, v: deep, x: 0, y: size[up] + gap },
    { u: deep, v: up, x: size[across] + gap, y: 0 },
  ];
  const margin = 30, number1 = value => (value * scale).toFixed(1);
  const parts = [];
  for (const { u, v, x, y } of views) {
    const seen = new Set();
    let path = "";
    for (let k = 0; k < lines.length; k += 6) {
      const ends = [0, 3].map(j => [
        number1(x + lines[k + j + u] - low[u]),
        number1(y + size[v] - lines[k + j + v] + low[v]),
      ].join(" "));
      const name = ends.slice().sort().join("L");
      if (ends[0] === ends[1] || seen.has(name)) continue;
      seen.add(name);
      path += "M" + ends[0] + "L" + ends[1];
    }
    parts.push(`<path d="${path}"/>`);
  }
  const text = (x, y, value, turned) => `<text x="${number1(x)}" y="${number1(y)}" text-anchor="middle"` +
    (turned ? ` transform="rotate(-90 ${number1(x)} ${number1(y)})" dy="-6"` : ` dy="-6"`) +
    `>${shownNumber(Math.round(10 * value) / 10)}</text>`;
  parts.push(text(size[across] / 2, 0, size[across]), text(0, size[up] / 2, size[up], true),
    text(size[across] + gap + size[deep] / 2, 0, size[deep]));
  const wide = total[0] * scale + 2 * margin, high = total[1] * scale + 2 * margin;
  return `<svg viewBox="${-margin} ${-margin} ${wide.toFixed(0)} ${high.toFixed(0)}" role="img" ` +
    `aria-label="three views of ${escaped(number.number)}, overall sizes in mm">${parts.join("")}</svg>`;
}

function escaped(text) {
  const names = { "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;", "'": "&#39;" };
  return String(text).replace(/[&<>"']/g, c => names[c]);
}
