// Puts the page together: unpacks the recording, shows it as the address says, and gives scripts a handle.
//
// The address may say what to show: #frame=120&camera=x,y,z,tx,ty,tz&color=island&body=7&joints=1&drawings=1&labels=1&contacts=1&
// normals=1&bounds=1&grid=1&solid=1&theme=dark&loop=1&follow=1&fine=1&occlusion=1&fit=1.2&bare=1. The frame may be `picture`, the
// one that the scene chose; `fit`: the camera frames what is there at this moment, where the whole run is so many times as large.
// Scripts and tests use window.fulcrum, which is there once the page is ready.
import { Controls } from './controls.js';
import { unpack } from './decode.js';
import { jointSummary } from './joints.js';
import { bodyInfo, showMessage } from './panel.js';
import { Viewer } from './viewer.js';

const SWITCHES = ['joints', 'drawings', 'labels', 'contacts', 'normals', 'bounds', 'grid', 'solid'];

function applyAddress(viewer, wanted) {
  const camera = (wanted.get('camera') ?? '').split(',').map(Number);
  if (camera.length === 6 && camera.every(Number.isFinite)) {
    viewer.stage.camera.position.set(...camera.slice(0, 3));
    viewer.stage.controls.target.set(...camera.slice(3));
    viewer.stage.controls.update();
  }
  if (wanted.has('theme')) viewer.setTheme(wanted.get('theme') === 'dark' ? 'dark' : 'light');
  if (wanted.has('color')) viewer.setMode(wanted.get('color'));
  for (const what of SWITCHES) if (wanted.has(what)) viewer.show(what, wanted.get(what) === '1');
  if (wanted.has('body')) viewer.select(Number(wanted.get('body')));
  if (wanted.get('loop') === '1') viewer.setLooping(true);
  const frame = wanted.get('frame');
  if (frame === 'picture') viewer.seek((viewer.recording.view?.picture ?? 0.5) * viewer.timeline.lastFrame);
  else if (frame !== null) viewer.seek(Number(frame));
  else if (!matchMedia('(prefers-reduced-motion: reduce)').matches) viewer.setPlaying(true);
  if (Number(wanted.get('fit')) > 0) viewer.frameMoment(Number(wanted.get('fit')));
  if (wanted.get('follow') === '1') viewer.setFollowing(true);
}

function publish(viewer) {
  const { recording, timeline, stage } = viewer;
  window.fulcrum = {
    frameCount: recording.frameCount,
    bodyCount: recording.bodyCount,
    get frame() { return timeline.frame; },
    get playing() { return viewer.isPlaying; },
    get selected() { return viewer.selected; },
    get mode() { return viewer.mode; },
    // Of the last picture: draw calls and triangles, with those of the shadows, without those of ambient occlusion.
    get drawn() { return { calls: stage.renderer.info.render.calls, triangles: stage.renderer.info.render.triangles }; },
    get videoSize() { return viewer.videoSize; },
    seek(frame) { viewer.seek(frame); viewer.drawNow(); },
    play() { viewer.setPlaying(true); },
    color(mode) { viewer.setMode(mode); viewer.drawNow(); },
    show(what, isShown) { viewer.show(what, isShown); viewer.drawNow(); },
    pick(x, y) { return viewer.pick(x, y); },
    select(body) { viewer.select(body); viewer.drawNow(); },
    body(id) { return bodyInfo(recording, timeline, id); },
    joints() { return jointSummary(recording, timeline.frame); },
    camera() { return [...stage.camera.position.toArray(), ...stage.controls.target.toArray()]; },
    // Where a place of the world is in the picture: -1 .. 1 from left to right and from below to above.
    project(x, y, z) { return stage.project(x, y, z); },
    subject: stage.subject,
    fit() { viewer.frameMoment(); viewer.drawNow(); },
    settle() { viewer.drawNow(); },
  };
}

async function start() {
  const wanted = new URLSearchParams(location.hash.slice(1));
  if (wanted.get('bare') === '1') document.body.classList.add('bare');
  const element = document.getElementById('recording');
  try {
    const recording = await unpack(element.textContent);
    element.remove();
    const given = (name) => (wanted.has(name) ? wanted.get(name) === '1' : undefined);
    const viewer = new Viewer(recording, given('fine'), given('occlusion'));
    new Controls(viewer);
    applyAddress(viewer, wanted);
    viewer.drawNow();
    publish(viewer);
    showMessage('');
  } catch (error) {
    showMessage(`This recording cannot be shown: ${error.message}`);
    console.error(error);
  }
}

start();
