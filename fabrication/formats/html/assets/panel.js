// Beside the model: what is selected, what colors mean, what is shown.

class Panel {
  constructor(model, view, tables) {
    Object.assign(this, { model, view, tables });
    this.quantities = quantities(model);
    this.hidden = new Set();
    this.measuring = null;
    this.step = 0;
    this.colorBox();
    this.roles();
    this.controls();
    this.problems();
    this.get("marks").checked = model.kinds.some(kind => kind.labelled);
    if (model.motion) this.motion();
    if (model.steps.length) this.order();
    view.picked = (hit, more) => this.picked(hit, more);
    view.drawn = () => this.labels();
    window.addEventListener("hashchange", () => this.follow());
    this.follow();
  }

  get(id) { return document.getElementById(id); }

  // --- selection -------------------------------------------------------------------------------
  picked(hit, more) {
    if (this.measuring) return this.measure(hit);
    if (!hit) return more ? undefined : this.select([]);
    const chosen = new Set(more ? this.view.selected : []);
    if (chosen.has(hit.piece)) chosen.delete(hit.piece); else chosen.add(hit.piece);
    this.select([...chosen]);
  }

  select(pieces, look = false) {
    this.view.selected = new Set(pieces);
    this.view.paint();
    this.view.drawEdges();
    if (look && pieces.length) this.view.fit(null, pieces);
    this.get("selection").innerHTML = pieces.length === 1 ? this.one(pieces[0])
      : pieces.length ? this.many(pieces) : "<p class=\"soft\">Click a part, or a mark in a table.</p>";
    this.tables.mark(pieces);
    const hash = pieces.length === 1 ? "#" + encodeURIComponent(this.model.pieces[pieces[0]].mark) : "";
    if (hash !== location.hash) history.replaceState(null, "", hash || location.pathname + location.search);
  }

  follow() {
    const k = this.model.byMark.get(decodeURIComponent(location.hash.slice(1)));
    this.select(k === undefined ? [] : [k], k !== undefined);
  }

  one(k) {
    const { mark, number, failed, rows } = this.model.pieces[k], kind = this.view.kind(number);
    const files = number.files.map(f => `<a href="${escaped(encodeURI(f))}">${escaped(f)}</a>`);
    const lists = rows.filter(([t, r]) => this.model.tables[t].pieces[r].length <= number.count)
      .map(([t, r]) => this.row(t, r)).join("");
    return `<h3>${escaped(mark)} <small>${escaped(number.number)}, ${escaped(kind.role)}</small></h3>` +
      `<p>${failed ? "<b class=\"bad\">rejected</b>, " : ""}${shownMass(number.mass_kg)}, ` +
      `${escaped(number.material)}; ${number.count} of this number</p>` + drawing(number) +
      (files.length ? `<p class="files">${files.join("<br>")}</p>` : "") + lists + this.checks(k);
  }

  row(t, r) {
    const table = this.model.tables[t];
    const cells = table.columns.map((column, c) => [column, table.rows[r][c]])
      .filter(([column, value]) => value !== null && value !== "" && !column.hidden)
      .map(([column, value]) => `<dt title="${escaped(column.meaning)}">${escaped(column.heading)}</dt>` +
        `<dd>${escaped(cellText(value, column.decimals))}</dd>`);
    return `<details${table.pieces[r].length === 1 ? " open" : ""}><summary>${escaped(table.title)}` +
      `</summary><dl>${cells.join("")}</dl></details>`;
  }

  checks(k) {
    const { names, limits, rows } = this.model.checks, own = rows[k];
    if (!own || !own.length) return "";
    const bad = own.filter(check => !check[1]).length;
    const lines = own.map(([name, passed, value, limit, other]) =>
      `<tr${passed ? "" : " class=\"bad\""}><td>${escaped(words(names[name]))}` +
      `${other ? " to " + escaped(other) : ""}</td><td class="n">${escaped(shownNumber(value))}</td>` +
      `<td class="n">${escaped(shownNumber(limits[limit]))}</td><td>${passed ? "ok" : "failed"}</td></tr>`);
    return `<details${bad ? " open" : ""}><summary>${own.length} checks, ${bad} failed</summary><table>` +
      `<thead><tr><th>check</th><th class="n">value</th><th class="n">limit</th><th></th></tr></thead>` +
      `<tbody>${lines.join("")}</tbody></table></details>`;
  }

  many(pieces) {
    const mass = pieces.reduce((all, k) => all + this.model.pieces[k].number.mass_kg, 0);
    const marks = pieces.slice(0, 200).map(k => this.link(k)).join(" ");
    const numbers = [...new Set(pieces.map(k => this.model.pieces[k].number.number))];
    const of = numbers.length === 1 ? ` of ${escaped(numbers[0])}` : "";
    return `<h3>${pieces.length} pieces${of}</h3><p>${shownMass(mass)}</p>` +
      `<p>${marks}${pieces.length > 200 ? " and more" : ""}</p>`;
  }

  link(k) {
    const mark = this.model.pieces[k].mark;
    return `<a href="#${escaped(encodeURIComponent(mark))}">${escaped(mark)}</a>`;
  }

  // --- colors ----------------------------------------------------------------------------------
  colorBox() {
    const box = this.get("color");
    const names = ["role", "part number", "status", ...this.quantities.keys()];
    box.innerHTML = names.map(name => `<option>${escaped(name)}</option>`).join("");
    box.onchange = () => this.color(box.value);
    this.color("role");
  }

  color(name) {
    const { pieces, numbers, failed_color: red } = this.model, legend = this.get("legend");
    const values = this.quantities.get(name);
    let colors;
    if (values) {
      const [low, high] = extent(values.values());
      colors = pieces.map((_, k) => values.has(k) ? scale((values.get(k) - low) / (high - low || 1)) : PALE);
      const stops = [0, 0.25, 0.5, 0.75, 1].map(t => scale(t)).join(",");
      legend.innerHTML = `<span>${escaped(shownNumber(low))}</span><i style="background:` +
        `linear-gradient(90deg,${stops})"></i><span>${escaped(shownNumber(high))}</span>` +
        `<span class="soft">${values.size} pieces have it</span>`;
    } else if (name === "part number") {
      const place = new Map(numbers.map((n, i) => [n, i]));
      colors = pieces.map(piece => `hsl(${(place.get(piece.number) * 137.508) % 360} 60% 55%)`);
      legend.innerHTML = `<span class="soft">${numbers.length} part numbers; pieces of one color are equal</span>`;
    } else if (name === "status") {
      colors = pieces.map(piece => piece.failed ? red : "#5aa469");
      const bad = pieces.filter(piece => piece.failed).length;
      legend.innerHTML = `<span class="soft">${pieces.length - bad} ok, ${bad} rejected (red)</span>`;
    } else {
      colors = pieces.map(piece => piece.failed ? red : piece.number.color);
      legend.innerHTML = "";
    }
    this.view.materials[1].opacity = name === "role" ? 0.38 : 0.85;
    this.view.colors = colors;
    this.view.paint();
  }

  // --- what is shown ---------------------------------------------------------------------------
  roles() {
    const place = this.get("roles"), counts = this.model.kinds.map(() => 0);
    for (const piece of this.model.pieces) counts[piece.number.kind]++;
    place.innerHTML = this.model.kinds.map((kind, k) => `<label><input type="checkbox" checked data-k="${k}">` +
      `<i style="background:${kind.color}"></i>${escaped(kind.title)} ${counts[k]}</label>`).join("");
    place.onchange = e => {
      const k = Number(e.target.dataset.k);
      if (e.target.checked) this.hidden.delete(k); else this.hidden.add(k);
      this.show();
    };
  }

  show() {
    const past = this.step > 0 ? new Set(this.model.steps.slice(0, this.step).flatMap(s => s.pieces)) : null;
    this.view.visible = this.model.pieces.map((piece, k) =>
      !this.hidden.has(piece.number.kind) && (!past || past.has(k)));
    this.view.paint();
    this.view.drawEdges();
  }

  controls() {
    const view = this.view, explode = this.get("explode"), axis = this.get("axis"), part = this.get("section");
    explode.oninput = () => { view.spread = Number(explode.value); view.placeAll(); view.draw(); };
    const cut = () => { part.disabled = axis.value === ""; view.section(axis.value, Number(part.value)); };
    axis.onchange = cut;
    part.oninput = cut;
    const looks = { all: [1, -1.4, 0.95], top: [0, -0.001, 1], front: [0, -1, 0.001], side: [1, 0, 0.001] };
    for (const button of document.querySelectorAll("[data-look]"))
      button.onclick = () => view.fit(looks[button.dataset.look]);
    this.get("zoom").onclick = () => view.fit(null, [...view.selected]);
    this.get("marks").onchange = () => this.labels();
    this.get("measure").onclick = () => {
      this.measuring = this.measuring ? null : [];
      this.get("measure").setAttribute("aria-pressed", String(Boolean(this.measuring)));
      this.get("measured").textContent = this.measuring ? "click two points" : "";
      this.rule([]);
    };
    this.get("find").onsubmit = e => {
      e.preventDefault();
      const asked = this.get("mark").value.trim().toUpperCase();
      const found = this.model.pieces.map((_, k) => k).filter(k => {
        const { mark, number } = this.model.pieces[k];
        return mark.toUpperCase() === asked || number.number.toUpperCase() === asked;
      });
      this.get("found").textContent = found.length ? "" : "no such mark or number";
      if (found.length) this.select(found, true);
    };
  }

  measure(hit) {
    if (!hit) return;
    if (this.measuring.length === 2) this.measuring = [];
    this.measuring.push(hit.point);
    const [a, b] = this.measuring;
    this.rule(this.measuring);
    this.get("measured").textContent = !b ? "click the second point"
      : a.distanceTo(b).toFixed(1) + " mm (x " + Math.abs(a.x - b.x).toFixed(1) + ", y " +
        Math.abs(a.y - b.y).toFixed(1) + ", z " + Math.abs(a.z - b.z).toFixed(1) + ")";
  }

  rule(points) {
    const values = points.length === 2 ? points.flatMap(p => p.toArray()) : [];
    this.view.ruler.geometry.dispose();
    this.view.ruler.geometry = new THREE.BufferGeometry();
    this.view.ruler.geometry.setAttribute("position",
      new THREE.BufferAttribute(new Float32Array(values), 3));
    this.view.draw();
  }

  // Marks beside the pieces: of a small model those of the roles that have them, or all; and those
  // that are selected.
  labels() {
    const place = this.get("labels"), view = this.view, { pieces, kinds } = this.model;
    const all = pieces.map((_, k) => k), some = all.filter(k => kinds[pieces[k].number.kind].labelled);
    const few = [some, all].find(own => own.length > 0 && own.length <= 60) || [];
    const wanted = this.get("marks").checked ? [...new Set([...few, ...[...view.selected].slice(0, 60)])] : [];
    const point = new THREE.Vector3();
    place.innerHTML = wanted.filter(k => view.visible[k]).map(k => {
      const piece = this.model.pieces[k];
      const at = view.pixel(point.copy(piece.middle).applyMatrix4(piece.matrix));
      return at ? `<span${view.selected.has(k) ? " class=\"chosen\"" : ""} style="left:${at[0].toFixed(0)}px;top:${at[1].toFixed(0)}px">` +
        `${escaped(piece.mark)}</span>` : "";
    }).join("");
  }

  problems() {
    const { names, rows } = this.model.checks, found = new Map();
    rows.forEach((own, k) => own.forEach(([name, passed]) => {
      if (passed) return;
      if (!found.has(name)) found.set(name, new Set());
      found.get(name).add(k);
    }));
    const place = this.get("failed");
    place.innerHTML = [...found].map(([name, own]) => `<li><button type="button" data-name="${name}">` +
      `show</button> ${escaped(words(names[name]))}: ${own.size} piece${own.size > 1 ? "s" : ""}</li>`).join("");
    place.onclick = e => {
      if (e.target.dataset.name) this.select([...found.get(Number(e.target.dataset.name))], true);
    };
  }
}

// Colors from blue over green and yellow (viridis, of 5 stops), for parts from 0 to 1.
function scale(part) {
  const stops = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];
  const at = Math.min(Math.max(part, 0), 1) * (stops.length - 1), k = Math.min(Math.floor(at), stops.length - 2);
  const mixed = stops[k].map((low, i) => Math.round(low + (at - k) * (stops[k + 1][i] - low)));
  return `rgb(${mixed.join(",")})`;
}
