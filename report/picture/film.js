// SPDX-License-Identifier: Apache-2.0
// The film of a page: predicted motions over the measured points, to turn and to scrub through, on
// one screen or on several that move alike. Positions come as 16-bit steps from a corner of an
// upright frame (x right, y away, z up), 65535 = not seen.
'use strict';
(() => {
  const byId = (id) => document.getElementById(id);
  const screens = [...document.querySelectorAll('.film canvas')].map((canvas) => (
    {canvas, context: canvas.getContext('2d'), layer: canvas.dataset.layer}));
  const unseen = 65535;

  function decode(text, Type = Uint16Array) {
    return new Type(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
  }

  const recordings = JSON.parse(byId('film-data').textContent);
  for (const recording of recordings) {
    for (const name of ['measured', 'controllers', 'ground']) {
      recording[name] = decode(recording[name]);
    }
    for (const layer of recording.layers) {
      layer.springs = decode(layer.springs, Uint32Array);
      layer.positions = decode(layer.positions);
      layer.points = layer.points ? decode(layer.points) : null;
    }
    for (const mark of recording.marks) mark.anchor = mark.anchor ? decode(mark.anchor) : null;
    // frames that are in the data, and numbers a frame
    recording.shown = Math.ceil(recording.frames / recording.stride);
    recording.points = recording.measured.length / recording.shown;
    recording.held = recording.controllers.length / recording.shown;
  }

  // the state of the film: all that draw() depends on
  const state = {recording: 0, layer: 0, frame: 0, playing: false, azimuth: 0, elevation: 0,
                 zoom: 1};
  const current = () => recordings[state.recording];
  // what frame `frame` of the recording is called: [first frame, name, whether it was fitted]
  const spanOf = (recording, frame) => recording.spans.findLast((span) => span[0] <= frame);

  // ---- projection: a weak perspective from `distance` sizes away

  const distance = 4;

  function project(canvas, values, from, count, scale) {
    const {corner, step, size} = current();
    const [ca, sa] = [Math.cos(state.azimuth), Math.sin(state.azimuth)];
    const [ce, se] = [Math.cos(state.elevation), Math.sin(state.elevation)];
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    const out = new Float32Array(count);
    for (let i = 0; i < count; i += 3) {
      if (values[from + i] === unseen) {
        out[i] = NaN;
        continue;
      }
      const x = corner[0] + step * values[from + i];
      const y = corner[1] + step * values[from + i + 1];
      const z = corner[2] + step * values[from + i + 2];
      const right = ca * x + sa * y;
      const away = ca * y - sa * x;
      const depth = (ce * away - se * z) / size;  // in sizes, away from the viewer
      const s = scale * distance / (distance + depth);
      out[i] = width / 2 + s * right;
      out[i + 1] = height / 2 - s * (se * away + ce * z);
      out[i + 2] = depth;
    }
    return out;
  }

  // ---- drawing

  function strokeLines(context, width, opacity, style, draw) {
    context.beginPath();
    draw();
    context.lineWidth = width;
    context.globalAlpha = opacity;
    context.strokeStyle = style;
    context.stroke();
    context.globalAlpha = 1;
  }

  // springs in three layers, the nearer the darker
  function drawSprings(context, style, springs, nodes, held, count) {
    const at = (column) => column < count ? [nodes, 3 * column] : [held, 3 * (column - count)];
    const opacity = Math.min(0.75, Math.max(0.2, 25 / Math.sqrt(springs.length)));
    for (let layer = 0; layer < 3; ++layer) {
      strokeLines(context, 1, opacity * (0.45 + 0.275 * layer), style, () => {
        for (let e = 0; e < springs.length; e += 2) {
          const [p, i] = at(springs[e]);
          const [q, j] = at(springs[e + 1]);
          const depth = (p[i + 2] + q[j + 2]) / 2;
          const its = depth > 0.1 ? 0 : depth > -0.1 ? 1 : 2;
          if (its !== layer) continue;
          context.moveTo(p[i], p[i + 1]);
          context.lineTo(q[j], q[j + 1]);
        }
      });
    }
  }

  function drawDots(context, dots, radius, style, square) {
    context.fillStyle = style;
    for (let i = 0; i < dots.length; i += 3) {
      if (Number.isNaN(dots[i])) continue;
      if (square) {
        context.fillRect(dots[i] - radius, dots[i + 1] - radius, 2 * radius, 2 * radius);
      } else {
        context.beginPath();
        context.arc(dots[i], dots[i + 1], radius, 0, 7);
        context.fill();
      }
    }
  }

  // a ring where an effect acts on the body, and a line to what holds it there
  function drawMark(context, style, node, anchor) {
    strokeLines(context, 2, 0.9, style, () => {
      context.arc(node[0], node[1], 9, 0, 7);
      if (!anchor) return;
      context.moveTo(node[0], node[1]);
      context.lineTo(anchor[0], anchor[1]);
      for (const side of [-1, 1]) {
        context.moveTo(anchor[0] - 6, anchor[1] - 6 * side);
        context.lineTo(anchor[0] + 6, anchor[1] + 6 * side);
      }
    });
  }

  function clear({canvas, context}) {
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (canvas.width !== Math.round(width * ratio)) canvas.width = Math.round(width * ratio);
    if (canvas.height !== Math.round(height * ratio)) canvas.height = Math.round(height * ratio);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
  }

  function drawScreen(screen) {
    const {canvas, context} = screen;
    const recording = current();
    const index = screen.layer === undefined ? state.layer : Number(screen.layer);
    const layer = recording.layers[index];
    const style = getComputedStyle(canvas);
    const colour = (name) => style.getPropertyValue(name);
    clear(screen);

    const scale = state.zoom * recording.fit;
    const t = state.frame;
    const whole = (values) => project(canvas, values, 0, values.length, scale);
    const part = (values, size) => project(canvas, values, t * size, size, scale);
    const ground = whole(recording.ground);
    strokeLines(context, 0.7, 0.35, colour('--muted'), () => {
      for (let i = 0; i < ground.length; i += 6) {
        context.moveTo(ground[i], ground[i + 1]);
        context.lineTo(ground[i + 3], ground[i + 4]);
      }
    });
    const nodes = part(layer.positions, 3 * layer.nodes);
    const held = part(recording.controllers, recording.held);
    const measured = part(recording.measured, recording.points);
    const predicted = layer.points ? part(layer.points, recording.points) : nodes;
    if (byId('show-springs').checked) {
      drawSprings(context, colour('--predicted'), layer.springs, nodes, held, layer.nodes);
    }
    if (byId('show-errors').checked) {
      strokeLines(context, 1, 0.65, colour('--measured'), () => {
        for (let i = 0; i < measured.length; i += 3) {
          context.moveTo(measured[i], measured[i + 1]);
          context.lineTo(predicted[i], predicted[i + 1]);
        }
      });
    }
    const radius = Math.min(4, Math.max(1.5, 24 / Math.sqrt(measured.length / 3)));
    if (byId('show-measured').checked) {
      drawDots(context, measured, radius, colour('--measured'), false);
    }
    drawDots(context, held, 3, colour('--controller'), true);
    for (const mark of recording.marks) {
      if (mark.layer !== index) continue;
      drawMark(context, colour('--effect'), nodes.subarray(3 * mark.node, 3 * mark.node + 3),
               mark.anchor && whole(mark.anchor));
    }
  }

  function draw() {
    screens.forEach(drawScreen);
    showTime();
  }

  // ---- time: the label, the slider and the cursor in the recording's plot

  function showTime() {
    const recording = current();
    const frame = state.frame * recording.stride;
    byId('frame').value = state.frame;
    byId('time').textContent = `${(frame / recording.fps).toFixed(2)} s  frame ${frame}  ` +
        spanOf(recording, frame)[1];
    for (const section of document.querySelectorAll('section[data-recording]')) {
      const plot = section.querySelector('.plot');
      if (!plot) continue;
      const [left, right] = [Number(plot.dataset.left), Number(plot.dataset.right)];
      const x = left + (right - left) * frame / (recording.frames - 1);
      const cursor = plot.querySelector('.cursor');
      const here = Number(section.dataset.recording) === state.recording;
      cursor.style.opacity = here ? 0.5 : 0;
      cursor.setAttribute('x1', x);
      cursor.setAttribute('x2', x);
    }
  }

  let lastTick = 0;
  let waiting = 0;  // frames of the recording that are due, but not whole yet

  function tick(now) {
    if (!state.playing) return;
    const recording = current();
    const rate = recording.fps / recording.stride * Number(byId('speed').value);
    waiting += Math.min(now - lastTick, 250) / 1000 * rate;
    lastTick = now;
    const whole = Math.floor(waiting);
    waiting -= whole;
    if (whole > 0) {
      state.frame = (state.frame + whole) % recording.shown;
      draw();
    }
    requestAnimationFrame(tick);
  }

  function setPlaying(playing) {
    state.playing = playing;
    byId('play').textContent = playing ? 'Pause' : 'Play';
    lastTick = performance.now();
    if (playing) requestAnimationFrame(tick);
  }

  // pixels a metre that show all that was measured
  function fit() {
    const recording = current();
    const [x, y, z] = recording.extent;
    const tall = Math.sin(recording.elevation) * y + Math.cos(recording.elevation) * z;
    const {canvas} = screens[0];
    recording.fit = 0.82 * Math.min(canvas.clientWidth / x, canvas.clientHeight / tall);
  }

  // a bar below the slider where frames were fitted
  function showFitted(recording) {
    const stops = recording.spans.flatMap(([first, , fitted], i) => {
      const next = i + 1 < recording.spans.length ? recording.spans[i + 1][0] : recording.frames;
      const colour = fitted ? 'var(--still)' : 'transparent';
      return [first, next].map((frame) => `${colour} ${100 * frame / recording.frames}%`);
    });
    byId('fit-part').style.background = `linear-gradient(to right, ${stops.join(', ')})`;
  }

  function choose(index) {
    const recording = recordings[index];
    state.recording = index;
    state.azimuth = 0;
    state.elevation = recording.elevation;
    state.zoom = 1;
    state.frame = Math.min(recording.shown - 1, Math.floor(recording.begin / recording.stride));
    byId('frame').max = recording.shown - 1;
    showFitted(recording);
    fit();
    draw();
  }

  // ---- input

  byId('play').onclick = () => setPlaying(!state.playing);
  byId('frame').oninput = (event) => {
    setPlaying(false);
    state.frame = Number(event.target.value);
    draw();
  };
  byId('recording').onchange = (event) => choose(Number(event.target.value));
  byId('level').onchange = (event) => {
    state.layer = Number(event.target.value);
    draw();
  };
  for (const id of ['show-springs', 'show-measured', 'show-errors']) byId(id).onchange = draw;
  byId('recording').hidden = recordings.length === 1;
  byId('level').hidden = byId('level').length < 2;

  let grabbed = null;
  for (const {canvas} of screens) {
    canvas.onpointerdown = (event) => {
      grabbed = [event.clientX, event.clientY];
      canvas.setPointerCapture(event.pointerId);
    };
    canvas.onpointermove = (event) => {
      if (!grabbed) return;
      state.azimuth += (event.clientX - grabbed[0]) * 0.008;
      state.elevation += (event.clientY - grabbed[1]) * 0.008;
      state.elevation = Math.min(1.57, Math.max(-1.57, state.elevation));
      grabbed = [event.clientX, event.clientY];
      draw();
    };
    canvas.onpointerup = canvas.onpointercancel = () => { grabbed = null; };
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      state.zoom = Math.min(20, Math.max(0.2, state.zoom * Math.exp(-event.deltaY * 0.001)));
      draw();
    }, {passive: false});
  }
  window.addEventListener('resize', () => { fit(); draw(); });
  window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', draw);

  choose(0);
})();
