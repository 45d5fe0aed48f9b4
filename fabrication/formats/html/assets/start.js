// What moves, the order in which pieces go together, and the start of it all.

Panel.prototype.motion = function () {
  const { motion } = this.model, slider = this.get("pose"), play = this.get("play");
  const touches = this.get("touches");
  this.get("motion").hidden = false;
  slider.max = motion.values.length - 1;
  const show = () => {
    const pose = Number(slider.value);
    this.view.pose = pose;
    this.view.placeAll();
    this.view.draw();
    this.get("reading").textContent = motion.driver + " " + motion.values[pose].toFixed(1) + "°" +
      (pose === motion.design ? " (design)" : "");
    touches.textContent = motion.touches.filter(touch => touch.pose === pose).map(t => t.text).join("; ");
  };
  slider.value = motion.design;
  slider.oninput = show;
  let running = null, way = 1;
  play.onclick = () => {
    if (running) clearInterval(running);
    play.textContent = running ? "Play" : "Pause";
    running = running ? null : setInterval(() => {
      const next = Number(slider.value) + way;
      if (next < 0 || next > Number(slider.max)) way = -way;
      slider.value = Number(slider.value) + way;
      show();
    }, 60);
  };
  show();
};

Panel.prototype.order = function () {
  const { steps } = this.model, text = this.get("steptext");
  this.get("order").hidden = false;
  this.get("step").max = steps.length;
  const whole = `all (${steps.length} steps)`;
  text.textContent = whole;
  const show = step => {
    this.step = Math.min(Math.max(step, 0), steps.length);
    this.get("step").value = this.step;
    const now = this.step ? steps[this.step - 1] : null;
    text.textContent = now ? `${this.step} of ${steps.length}: ${now.title}` : whole;
    this.show();
    this.select(now ? now.pieces : []);
  };
  this.get("step").oninput = () => { stop(); show(Number(this.get("step").value)); };
  this.get("before").onclick = () => { stop(); show(this.step - 1); };
  this.get("after").onclick = () => { stop(); show(this.step < steps.length ? this.step + 1 : 0); };
  let running = null;
  const stop = () => { clearInterval(running); running = null; this.get("build").textContent = "Play"; };
  this.get("build").onclick = () => {
    if (running) return stop();
    this.get("build").textContent = "Pause";
    running = setInterval(() => {
      if (this.step >= steps.length) stop();
      else show(this.step + 1);
    }, Math.min(900, Math.max(150, 20000 / steps.length)));
  };
};

(async () => {
  const model = await loadModel();
  const tables = new Tables(model, document.getElementById("tables"));
  let view = null;
  const paper = new Paper(model, tables);
  try {
    view = new View(document.getElementById("view"), model);
  } catch (error) {
    document.getElementById("view").innerHTML = `<p class="bad">This browser shows no models (WebGL 2 is ` +
      `missing): ${escaped(error.message)}. All tables are below.</p>`;
    document.documentElement.dataset.ready = "tables";
    return;
  }
  const panel = new Panel(model, view, tables);
  paper.view = view;
  tables.chosen = pieces => {
    panel.select(pieces, true);
    document.getElementById("view").scrollIntoView({ block: "nearest" });
  };
  window.ddgfab = { model, view, panel, tables };
  document.documentElement.dataset.ready = "model";
})();
