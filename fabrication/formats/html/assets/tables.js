// Schedules: made when they are opened, and whole when the page is printed.

const SHOWN_ROWS = 300, LINE = 175;  // rows made at a time; characters of a printed line

function cellText(value, decimals) {
  if (value === null) return "";
  if (typeof value === "boolean") return value ? "yes" : "no";
  return typeof value === "number" && !Number.isInteger(value) ? value.toFixed(decimals) : String(value);
}

class Tables {
  constructor(model, place) {
    this.model = model;
    this.place = place;
    this.state = model.tables.map(table => ({ rows: table.rows.map((_, r) => r), all: false, count: SHOWN_ROWS }));
    place.innerHTML = model.tables.map((table, t) => `<details class="table" data-t="${t}"><summary>` +
      `${escaped(table.title)} <small>${table.rows.length} rows</small></summary>` +
      `<p class="soft">${escaped(table.about)}</p><div class="tools"><input type="search" ` +
      `placeholder="filter" aria-label="filter ${escaped(table.title)}"> ` +
      `<label><input type="checkbox"> all columns</label></div><div class="scroll"></div></details>`).join("");
    for (const box of place.querySelectorAll("details.table")) this.listen(box, Number(box.dataset.t));
  }

  listen(box, t) {
    const state = this.state[t], table = this.model.tables[t];
    box.addEventListener("toggle", () => { if (box.open) this.fill(box, t); });
    const [filter, all] = box.querySelectorAll("input");
    filter.oninput = () => {
      const asked = filter.value.trim().toLowerCase();
      state.rows = table.rows.map((_, r) => r).filter(r => !asked ||
        table.rows[r].some(v => v !== null && String(v).toLowerCase().includes(asked)));
      state.count = SHOWN_ROWS;
      this.fill(box, t);
    };
    all.onchange = () => { state.all = all.checked; this.fill(box, t); };
    box.querySelector(".scroll").onclick = e => {
      const heading = e.target.closest("button[data-c]"), row = e.target.closest("tr[data-r]");
      if (heading) this.sort(box, t, Number(heading.dataset.c));
      else if (e.target.dataset.more) { state.count += 10 * SHOWN_ROWS; this.fill(box, t); }
      else if (row && this.chosen) this.chosen(table.pieces[Number(row.dataset.r)]);
    };
  }

  sort(box, t, c) {
    const state = this.state[t], rows = this.model.tables[t].rows;
    state.down = state.by === c && !state.down;
    state.by = c;
    const order = (a, b) => a === null ? 1 : b === null ? -1 : typeof a === "number" && typeof b === "number"
      ? a - b : String(a).localeCompare(String(b), "en", { numeric: true });
    state.rows.sort((a, b) => order(rows[a][c], rows[b][c]) * (state.down ? -1 : 1) || a - b);
    this.fill(box, t);
  }

  columns(t, all) {
    const { columns, rows } = this.model.tables[t];
    return columns.map((_, c) => c).filter(c => all || !columns[c].hidden)
      .filter(c => all || rows.some(row => row[c] !== null && row[c] !== ""));
  }

  fill(box, t) {
    const table = this.model.tables[t], state = this.state[t], columns = this.columns(t, state.all);
    const side = columns.map(c => table.rows.some(row => typeof row[c] === "number") ? " class=\"n\"" : "");
    const head = columns.map((c, i) => `<th${side[i]} title="${escaped(table.columns[c].meaning)}">` +
      `<button type="button" data-c="${c}">${escaped(table.columns[c].heading)}</button></th>`);
    const body = state.rows.slice(0, state.count).map(r => `<tr data-r="${r}">` +
      columns.map((c, i) => `<td${side[i]}>${i ? this.cell(t, r, c) : this.button(t, r, c)}</td>`).join("") + "</tr>");
    const rest = state.rows.length - state.count;
    box.querySelector(".scroll").innerHTML = `<table><thead><tr>${head.join("")}</tr></thead>` +
      `<tbody>${body.join("")}</tbody></table>` +
      (rest > 0 ? `<button type="button" data-more="1">${rest} more rows</button>` : "");
    this.mark(this.marked || []);
  }

  cell(t, r, c) { return escaped(cellText(this.model.tables[t].rows[r][c], this.model.tables[t].columns[c].decimals)); }

  button(t, r, c) {
    const text = this.cell(t, r, c);
    return this.model.tables[t].pieces[r].length ? `<button type="button" class="link">${text || "show"}</button>` : text;
  }

  // Rows of what is selected stand out.
  mark(pieces) {
    this.marked = pieces;
    const wanted = new Set(pieces);
    for (const row of this.place.querySelectorAll("tr[data-r]")) {
      const t = Number(row.closest("details").dataset.t), own = this.model.tables[t].pieces[Number(row.dataset.r)];
      row.classList.toggle("chosen", own.length > 0 && own.some(k => wanted.has(k)));
    }
  }

  // Whole tables for paper: wide ones in blocks of columns, each with the first column.
  printed() {
    return this.model.tables.map((table, t) => {
      const columns = this.columns(t, false);
      const wide = columns.map(c => Math.min(44, Math.max(
        ...table.columns[c].heading.split(" ").map(word => word.length),
        ...table.rows.map(row => Math.min(44, cellText(row[c], table.columns[c].decimals).length)))) + 2);
      const blocks = [];
      for (let k = 1, block = [0], used = wide[0]; k <= columns.length; k++) {
        if (k === columns.length || (used + wide[k] > LINE && block.length > 1)) {
          blocks.push(block);
          block = [0];
          used = wide[0];
        }
        if (k < columns.length) { block.push(k); used += wide[k]; }
      }
      return blocks.map((block, b) => {
        const own = block.map(k => columns[k]);
        const side = own.map(c => table.rows.some(row => typeof row[c] === "number") ? " class=\"n\"" : "");
        const title = escaped(table.title) + (blocks.length > 1 ? ` (${b + 1} of ${blocks.length})` : "");
        return `<h2>${title}</h2><table><thead><tr>` + own.map((c, i) =>
          `<th${side[i]}>${escaped(table.columns[c].heading)}</th>`).join("") + "</tr></thead><tbody>" +
          table.rows.map((_, r) => "<tr>" + own.map((c, i) => `<td${side[i]}>${this.cell(t, r, c)}</td>`).join("") +
            "</tr>").join("") + "</tbody></table>";
      }).join("");
    }).join("");
  }
}
