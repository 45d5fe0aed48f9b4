// The model in three dimensions: two batches (opaque and glass), their sharp edges, one selection.

const HIGHLIGHT = "#ff7a00", PALE = "#c9d1d9";

class View {
  constructor(place, model) {
    this.place = place;
    this.model = model;
    this.offset = new Float32Array(3 * model.pieces.length);
    this.visible = model.pieces.map(() => true);
    this.colors = model.pieces.map(piece => piece.number.color);
    this.selected = new Set();
    this.pose = model.motion ? model.motion.design : -1;
    this.spread = 0;
    this.renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    this.renderer.setClearColor("#f4f6f8");
    this.renderer.domElement.setAttribute("role", "img");
    this.renderer.domElement.setAttribute("aria-label", "model; arrow keys turn it, + and - zoom");
    this.renderer.domElement.tabIndex = 0;
    place.prepend(this.renderer.domElement);
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(35, 1, 1, 1e6);
    this.camera.up.set(0, 0, 1);
    this.scene.add(new THREE.HemisphereLight("#ffffff", "#98a2ad", 2.3));
    this.sun = new THREE.DirectionalLight("#ffffff", 1.8);
    this.scene.add(this.sun, this.sun.target);
    this.controls = new THREE.OrbitControls(this.camera, this.renderer.domElement);
    this.controls.addEventListener("change", () => this.draw());
    this.plane = new THREE.Plane(new THREE.Vector3(-1, 0, 0), 0);
    this.cut = false;
    this.build();
    this.box = this.bounds();
    this.fit();
    new ResizeObserver(() => this.resize()).observe(place);
    this.resize();
    this.listen();
  }

  build() {
    const make = glass => new THREE.MeshLambertMaterial(glass
      ? { transparent: true, opacity: 0.38, side: THREE.DoubleSide, depthWrite: false }
      : { side: THREE.DoubleSide });
    this.materials = [make(false), make(true)];
    this.batches = this.materials.map((material, glass) => {
      const own = this.model.numbers.filter(n => Number(this.kind(n).glass) === glass);
      const pieces = own.reduce((all, n) => all + n.pieces.length, 0);
      if (!pieces) return null;
      const corners = own.reduce((all, n) => all + n.corners.length, 0);
      const batch = new THREE.BatchedMesh(pieces, corners, 0, material);
      batch.pieces = [];
      batch.sortObjects = false;
      for (const number of own) {
        const geometry = new THREE.BufferGeometry(), { position, normal } = shaded(number);
        geometry.setAttribute("position", new THREE.BufferAttribute(position, 3));
        geometry.setAttribute("normal", new THREE.BufferAttribute(normal, 3));
        const id = batch.addGeometry(geometry);
        for (const k of number.pieces) {
          const piece = this.model.pieces[k];
          piece.batch = batch;
          piece.instance = batch.addInstance(id);
          batch.pieces[piece.instance] = k;
          piece.middle = new THREE.Vector3(...number.low.map((x, i) => x + number.size[i] / 2));
        }
      }
      this.scene.add(batch);
      return batch;
    });
    this.edges = this.lines("#33404d", 0.55);
    this.chosen = this.lines(HIGHLIGHT, 1);
    this.chosen.material.depthTest = false;
    this.chosen.renderOrder = 2;
    this.ruler = this.lines("#c2185b", 1);
    this.ruler.material.depthTest = false;
    this.ruler.renderOrder = 3;
    this.placeAll();
    this.paint();
  }

  kind(number) { return this.model.kinds[number.kind]; }

  lines(color, opacity) {
    const material = new THREE.LineBasicMaterial({ color, opacity, transparent: true });
    const found = new THREE.LineSegments(new THREE.BufferGeometry(), material);
    found.frustumCulled = false;
    this.scene.add(found);
    return found;
  }

  // The placement of a piece, row by row, in the pose that is shown, moved outwards by `spread`.
  matrix(k) {
    const count = this.model.pieces.length;
    const values = this.pose < 0 ? this.model.placements.subarray(12 * k, 12 * k + 12)
      : this.model.poses.subarray(12 * (this.pose * count + k), 12 * (this.pose * count + k) + 12);
    const found = new THREE.Matrix4();
    found.set(...values, 0, 0, 0, 1);
    if (this.spread > 0) {
      const at = this.model.pieces[k].middle.clone().applyMatrix4(found);
      at.sub(this.center).multiplyScalar(this.spread);
      found.premultiply(new THREE.Matrix4().makeTranslation(at.x, at.y, at.z));
    }
    return found;
  }

  placeAll() {
    this.model.pieces.forEach((piece, k) => {
      piece.matrix = this.matrix(k);
      piece.batch.setMatrixAt(piece.instance, piece.matrix);
    });
    for (const batch of this.batches) if (batch) { batch.computeBoundingSphere(); }
    this.drawEdges();
  }

  drawEdges() {
    const of = pieces => {
      const size = pieces.reduce((all, piece) => all + piece.number.lines.length, 0);
      const found = new Float32Array(size), point = new THREE.Vector3();
      let at = 0;
      for (const piece of pieces) {
        const lines = piece.number.lines;
        for (let k = 0; k < lines.length; k += 3, at += 3) {
          point.set(lines[k], lines[k + 1], lines[k + 2]).applyMatrix4(piece.matrix);
          point.toArray(found, at);
        }
      }
      return found;
    };
    const set = (lines, values) => {
      lines.geometry.dispose();
      lines.geometry = new THREE.BufferGeometry();
      lines.geometry.setAttribute("position", new THREE.BufferAttribute(values, 3));
    };
    set(this.edges, of(this.model.pieces.filter((_, k) => this.visible[k])));
    set(this.chosen, of(this.model.pieces.filter((_, k) => this.visible[k] && this.selected.has(k))));
  }

  paint() {
    this.repaint();
    this.draw();
  }

  repaint() {
    const color = new THREE.Color();
    this.model.pieces.forEach((piece, k) => {
      color.set(this.selected.has(k) ? HIGHLIGHT : this.colors[k]);
      piece.batch.setColorAt(piece.instance, color);
      piece.batch.setVisibleAt(piece.instance, this.visible[k]);
    });
  }

  // Corners of the boxes of some pieces, of all of them in some poses where nothing is named.
  corners(pieces) {
    const found = [], shown = this.pose, all = this.model.pieces.map((_, k) => k);
    const poses = this.model.motion && !pieces ? this.model.motion.values.map((_, t) => t) : [this.pose];
    for (const pose of poses.filter((_, t) => t % Math.ceil(poses.length / 12) === 0)) {
      this.pose = pose;
      for (const k of pieces || all) {
        const { low, size } = this.model.pieces[k].number, matrix = this.matrix(k);
        for (let c = 0; c < 8; c++)
          found.push(new THREE.Vector3(...[0, 1, 2].map(i => low[i] + (c >> i & 1) * size[i])).applyMatrix4(matrix));
      }
    }
    this.pose = shown;
    return found;
  }

  bounds() {
    this.center = new THREE.Vector3();
    const box = new THREE.Box3().setFromPoints(this.corners());
    box.getCenter(this.center);
    return box;
  }

  // Looks at the whole, or at some pieces, from a direction, as near as they can be seen whole.
  fit(direction, pieces) {
    const points = this.corners(pieces && pieces.length ? pieces : undefined);
    if (!points.length) return;
    const away = (direction ? new THREE.Vector3(...direction)
      : pieces ? this.camera.position.clone().sub(this.controls.target) : new THREE.Vector3(1, -1.4, 0.95)).normalize();
    const right = new THREE.Vector3().crossVectors(this.camera.up, away).normalize();
    const up = new THREE.Vector3().crossVectors(away, right);
    const middle = axis => {
      const [low, high] = extent(points.map(p => p.dot(axis)));
      return (low + high) / 2;
    };
    const center = new THREE.Vector3();
    for (const axis of [right, up, away]) center.addScaledVector(axis, middle(axis));
    const slope = Math.tan(this.camera.fov * Math.PI / 360) / 1.06;
    const [, far] = extent(points.map(p => {
      const at = p.clone().sub(center);
      return at.dot(away) + Math.max(Math.abs(at.dot(up)) / slope,
        Math.abs(at.dot(right)) / slope / (this.camera.aspect || 1));
    }));
    const whole = this.box.getBoundingSphere(new THREE.Sphere()).radius;
    const distance = pieces && pieces.length ? Math.max(far, 0.2 * whole) : far;
    this.controls.target.copy(center);
    this.camera.position.copy(center).addScaledVector(away, distance);
    this.camera.near = Math.max(distance / 1000, whole / 10000);
    this.camera.far = distance + 20 * whole;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.draw();
  }

  resize() {
    const { clientWidth: wide, clientHeight: high } = this.place;
    if (!wide || !high) return;
    this.renderer.setSize(wide, high);
    this.camera.aspect = wide / high;
    this.camera.updateProjectionMatrix();
    if (!this.sized) { this.sized = true; this.fit(); }
    this.draw();
  }

  draw() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => this.drawNow());
  }

  drawNow() {
    this.waiting = false;
    this.sun.position.copy(this.camera.position);
    this.sun.target.position.copy(this.controls.target);
    this.renderer.render(this.scene, this.camera);
    this.place.dataset.calls = this.renderer.info.render.calls;
    if (this.drawn) this.drawn();
  }

  // The visible piece and point that a pixel shows; null where there is none.
  at(x, y) {
    const rect = this.renderer.domElement.getBoundingClientRect();
    const ray = new THREE.Raycaster();
    ray.setFromCamera(new THREE.Vector2(2 * (x - rect.left) / rect.width - 1,
      1 - 2 * (y - rect.top) / rect.height), this.camera);
    const hits = ray.intersectObjects(this.batches.filter(Boolean), false);
    const hit = hits.find(h => this.visible[h.object.pieces[h.batchId]] &&
      (!this.cut || this.plane.distanceToPoint(h.point) >= 0));
    return hit ? { piece: hit.object.pieces[hit.batchId], point: hit.point } : null;
  }

  section(axis, part) {
    this.cut = axis !== "";
    if (this.cut) {
      const k = "xyz".indexOf(axis), low = this.box.min.toArray()[k], high = this.box.max.toArray()[k];
      this.plane.normal.set(...[0, 1, 2].map(i => i === k ? -1 : 0));
      this.plane.constant = low + part * (high - low);
    }
    const planes = this.cut ? [this.plane] : [];
    for (const material of [...this.materials, this.edges.material]) {
      material.clippingPlanes = planes;
      material.needsUpdate = true;
    }
    this.renderer.localClippingEnabled = this.cut;
    this.draw();
  }

  listen() {
    const canvas = this.renderer.domElement;
    let down = null;
    canvas.addEventListener("pointerdown", e => { down = [e.clientX, e.clientY]; });
    canvas.addEventListener("pointerup", e => {
      if (down && Math.hypot(e.clientX - down[0], e.clientY - down[1]) < 6 && this.picked)
        this.picked(this.at(e.clientX, e.clientY), e.shiftKey || e.ctrlKey);
      down = null;
    });
    canvas.addEventListener("keydown", e => {
      const turn = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
      const zoom = { "+": 0.9, "=": 0.9, "-": 1.1 }[e.key];
      const away = this.camera.position.clone().sub(this.controls.target);
      if (turn[e.key]) {
        const [across, up] = turn[e.key];
        away.applyAxisAngle(this.camera.up, across * 0.12);
        const side = new THREE.Vector3().crossVectors(this.camera.up, away).normalize();
        away.applyAxisAngle(side, -up * 0.12);
      } else if (zoom) away.multiplyScalar(zoom);
      else return;
      e.preventDefault();
      this.camera.position.copy(this.controls.target).add(away);
      this.controls.update();
      this.draw();
    });
  }

  // Where a point [mm] is on the canvas, in pixels; null behind the camera.
  pixel(point) {
    const at = point.clone().project(this.camera);
    if (at.z > 1) return null;
    return [(at.x + 1) / 2 * this.place.clientWidth, (1 - at.y) / 2 * this.place.clientHeight];
  }
}
