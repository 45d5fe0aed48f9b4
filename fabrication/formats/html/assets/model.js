// The model as the page holds it: meshes once a part number, pieces, checks and schedules.

const WIDE = 2 ** 26;  // more than a mesh has vertices

async function unpacked(id) {
  const text = document.getElementById(id).textContent;
  const bytes = Uint8Array.from(atob(text), c => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer();
}

async function loadModel() {
  const content = JSON.parse(new TextDecoder().decode(await unpacked("content")));
  const numbers = await unpacked("numbers");
  let at = 0;
  const take = (Kind, count) => {
    const found = new Kind(numbers, at, count);
    at += Math.ceil(count * Kind.BYTES_PER_ELEMENT / 4) * 4;
    return found;
  };
  const sum = name => content.numbers.reduce((all, n) => all + n[name], 0);
  const wide = content.numbers.length > 0 && content.numbers[0].wide;
  const points = take(Uint16Array, 3 * sum("points"));
  const corners = take(wide ? Uint32Array : Uint16Array, 3 * sum("triangles"));
  let p = 0, c = 0;
  for (const number of content.numbers) {
    number.vertices = new Float32Array(3 * number.points);
    for (let k = 0; k < number.vertices.length; k++)
      number.vertices[k] = number.low[k % 3] + points[p + k] / 65535 * number.size[k % 3];
    number.corners = corners.subarray(c, c + 3 * number.triangles);
    p += 3 * number.points;
    c += 3 * number.triangles;
    number.pieces = [];
  }
  const count = content.pieces.length;
  const poses = content.motion ? content.motion.values.length : 0;
  content.placements = take(Float32Array, 12 * count);
  content.poses = take(Float32Array, 12 * count * poses);
  content.pieces = content.pieces.map(([mark, number, failed], k) => {
    content.numbers[number].pieces.push(k);
    return { mark, number: content.numbers[number], failed: failed === 1, rows: [] };
  });
  content.byMark = new Map(content.pieces.map((piece, k) => [piece.mark, k]));
  content.tables.forEach((table, t) => table.pieces.forEach((own, r) => {
    for (const k of own) content.pieces[k].rows.push([t, r]);
  }));
  return content;
}

// Corners of a mesh apart from each other, with normals that are smooth across blunt edges, and its
// sharp edges: faces that meet under more than 30 degrees.
function shaded(number) {
  const { vertices, corners } = number, count = corners.length / 3;
  const faces = new Float32Array(3 * count), around = new Map(), edges = new Map();
  for (let f = 0; f < count; f++) {
    const [a, b, c] = [0, 1, 2].map(k => 3 * corners[3 * f + k]);
    const u = [0, 1, 2].map(k => vertices[b + k] - vertices[a + k]);
    const v = [0, 1, 2].map(k => vertices[c + k] - vertices[a + k]);
    faces[3 * f] = u[1] * v[2] - u[2] * v[1];
    faces[3 * f + 1] = u[2] * v[0] - u[0] * v[2];
    faces[3 * f + 2] = u[0] * v[1] - u[1] * v[0];
    for (let k = 0; k < 3; k++) {
      const from = corners[3 * f + k], to = corners[3 * f + (k + 1) % 3];
      if (!around.has(from)) around.set(from, []);
      around.get(from).push(f);
      const name = from < to ? from * WIDE + to : to * WIDE + from;
      if (!edges.has(name)) edges.set(name, []);
      edges.get(name).push(f);
    }
  }
  const cosine = (f, g) => {
    const size = Math.hypot(faces[3 * f], faces[3 * f + 1], faces[3 * f + 2]) *
      Math.hypot(faces[3 * g], faces[3 * g + 1], faces[3 * g + 2]);
    const dot = faces[3 * f] * faces[3 * g] + faces[3 * f + 1] * faces[3 * g + 1] +
      faces[3 * f + 2] * faces[3 * g + 2];
    return size > 0 ? dot / size : 1;
  };
  const sharp = Math.cos(Math.PI / 6);
  const position = new Float32Array(9 * count), normal = new Float32Array(9 * count);
  for (let f = 0; f < count; f++) for (let k = 0; k < 3; k++) {
    const vertex = corners[3 * f + k], at = 9 * f + 3 * k;
    const n = [0, 0, 0];
    for (const g of around.get(vertex)) if (cosine(f, g) > sharp)
      for (let i = 0; i < 3; i++) n[i] += faces[3 * g + i];
    const size = Math.hypot(...n) || 1;
    for (let i = 0; i < 3; i++) {
      position[at + i] = vertices[3 * vertex + i];
      normal[at + i] = n[i] / size;
    }
  }
  const lines = [];
  for (const [name, [f, g]] of edges) if (g === undefined || cosine(f, g) < sharp) {
    const from = Math.floor(name / WIDE), to = name % WIDE;
    for (let i = 0; i < 3; i++) lines.push(vertices[3 * from + i]);
    for (let i = 0; i < 3; i++) lines.push(vertices[3 * to + i]);
  }
  number.lines = new Float32Array(lines);
  return { position, normal };
}

// Quantities that pieces can be colored by: name, and a value for each piece that has one. What
// checks measure comes first: torsion, lean, planarity, clearances; then columns of schedules.
function quantities(model) {
  const found = new Map();
  const put = (name, k, value) => {
    if (typeof value !== "number" || !isFinite(value)) return;
    if (!found.has(name)) found.set(name, new Map());
    found.get(name).set(k, value);
  };
  const measured = model.checks.names.map(name => /_(deg|mm|percent)$/.test(name) || name === "clearance");
  model.checks.rows.forEach((own, k) => {
    for (const [name, , value] of own) if (measured[name]) {
      const text = words(model.checks.names[name]) + (model.checks.names[name] === "clearance" ? " [mm]" : "");
      const before = found.get(text) && found.get(text).get(k);
      if (before === undefined || /clearance/.test(text) && value < before) put(text, k, value);
    }
  });
  model.pieces.forEach((piece, k) => put("longest side [mm]", k, Math.max(...piece.number.size)));
  model.pieces.forEach((piece, k) => put("mass [kg]", k, piece.number.mass_kg));
  const kept = new Set(found.keys());
  model.tables.forEach(table => table.pieces.forEach((own, r) => {
    if (own.length !== 1) return;
    table.columns.forEach((column, c) => {
      if (/_\d+(_|$)/.test(column.name)) return;
      if (/\[|count|quantity/.test(column.heading) && !/exact/.test(column.name))
        put(table.title + ": " + column.heading, own[0], table.rows[r][c]);
    });
  }));
  for (const [name, values] of found) {
    const [low, high] = extent(values.values());
    if (!(high > low) && !kept.has(name)) found.delete(name);
  }
  return found;
}

function extent(values) {
  let low = Infinity, high = -Infinity;
  for (const value of values) { low = Math.min(low, value); high = Math.max(high, value); }
  return [low, high];
}

function words(name) {
  const unit = /_(deg|mm|mm2|mm3|kg|percent)$/.exec(name);
  const text = (unit ? name.slice(0, unit.index) : name).replace(/_/g, " ");
  return unit ? text + " [" + (unit[1] === "percent" ? "%" : unit[1]) + "]" : text;
}

function shownNumber(value) {
  if (typeof value !== "number") return value === null ? "" : String(value);
  if (Number.isInteger(value)) return String(value);
  const size = Math.abs(value);
  return size >= 0.001 && size < 1e6 ? String(Number(value.toPrecision(6))) : value.toExponential(2);
}

function shownMass(kg) { return kg < 0.1 ? shownNumber(Number((1000 * kg).toPrecision(3))) + " g" : kg.toFixed(kg < 10 ? 3 : 2) + " kg"; }
