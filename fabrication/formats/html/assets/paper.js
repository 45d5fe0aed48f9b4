// What is printed: a picture of the model, the steps with a picture a group, and whole tables.

const PICTURE = [1400, 800], SMALL = [720, 480], MOST_PICTURES = 60, MOST_MARKS = 12;

class Paper {
  constructor(model, tables) {
    Object.assign(this, { model, tables, view: null });
    const place = document.getElementById("printed");
    window.addEventListener("beforeprint", () => {
      place.innerHTML = this.picture() + this.steps() + this.tables.printed();
    });
    window.addEventListener("afterprint", () => { place.innerHTML = ""; });
  }

  // The model as it is seen on the screen.
  picture() {
    if (!this.view) return "";
    const shown = [...document.querySelectorAll("#labels span")].map(span => this.model.byMark.get(span.textContent));
    return `<img class="whole" alt="the model" src="${this.drawn(PICTURE, shown)}">`;
  }

  // Steps in their groups: what was put together before, and the pieces of the group in another color.
  steps() {
    const groups = new Map(), { steps, pieces, kinds } = this.model;
    steps.forEach((step, n) => {
      const name = step.group || step.title;
      if (!groups.has(name)) groups.set(name, []);
      groups.get(name).push([n + 1, step]);
    });
    if (!groups.size) return "";
    const view = this.view, pictures = view !== null && groups.size <= MOST_PICTURES;
    const kept = pictures && { visible: view.visible, selected: view.selected, camera: view.camera.clone(),
      target: view.controls.target.clone(), spread: view.spread, pose: view.pose };
    if (pictures) {
      view.spread = 0;
      view.pose = this.model.motion ? this.model.motion.design : -1;
      view.placeAll();
    }
    const there = new Set(), found = [];
    for (const [name, own] of groups) {
      const now = own.flatMap(([, step]) => step.pieces), lines = own.map(([n, step]) =>
        `<li value="${n}"><span class="box"></span>${escaped(step.title)}</li>`).join("");
      now.forEach(k => there.add(k));
      let image = "";
      if (pictures) {
        view.visible = pieces.map((_, k) => there.has(k));
        view.selected = new Set(now);
        view.fit([1, -1.4, 0.95], now.length <= 40 ? now : undefined);
        const labelled = now.filter(k => kinds[pieces[k].number.kind].labelled);
        image = `<img alt="${escaped(name)}" src="${this.drawn(SMALL, labelled.slice(0, MOST_MARKS))}">`;
      }
      found.push(`<div class="group"><h3>${escaped(name)}</h3>${image}<ol>${lines}</ol></div>`);
    }
    if (pictures) {
      Object.assign(view, { visible: kept.visible, selected: kept.selected, spread: kept.spread, pose: kept.pose });
      view.camera.copy(kept.camera);
      view.controls.target.copy(kept.target);
      view.placeAll();
      view.paint();
      view.resize();
    }
    return `<h2>Order</h2><div class="groups">${found.join("")}</div>`;
  }

  // A picture of what the view shows, with the marks of some pieces, as the text of an image.
  drawn([wide, high], marks) {
    const view = this.view, canvas = document.createElement("canvas"), aspect = view.camera.aspect;
    Object.assign(canvas, { width: wide, height: high });
    const ratio = view.renderer.getPixelRatio();
    view.renderer.setPixelRatio(1);
    view.renderer.setSize(wide, high, false);
    view.camera.aspect = wide / high;
    view.camera.updateProjectionMatrix();
    view.repaint();
    view.drawEdges();
    view.renderer.setClearColor("#ffffff");
    view.renderer.render(view.scene, view.camera);
    const pen = canvas.getContext("2d"), point = new THREE.Vector3();
    pen.drawImage(view.renderer.domElement, 0, 0);
    pen.font = `${high > 600 ? 15 : 18}px sans-serif`;
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    for (const k of marks) {
      const piece = this.model.pieces[k], at = point.copy(piece.middle).applyMatrix4(piece.matrix).project(view.camera);
      if (at.z > 1) continue;
      const x = (at.x + 1) / 2 * wide, y = (1 - at.y) / 2 * high, half = pen.measureText(piece.mark).width / 2 + 4;
      pen.fillStyle = "rgba(255, 255, 255, 0.85)";
      pen.fillRect(x - half, y - 10, 2 * half, 20);
      pen.fillStyle = "#1d2733";
      pen.fillText(piece.mark, x, y);
    }
    view.renderer.setClearColor("#f4f6f8");
    view.renderer.setPixelRatio(ratio);
    view.camera.aspect = aspect;
    view.camera.updateProjectionMatrix();
    view.resize();
    return canvas.toDataURL("image/jpeg", 0.85);
  }
}
