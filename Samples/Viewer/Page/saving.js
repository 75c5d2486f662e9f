// Saves what the canvas shows: a picture (PNG) and a video of the whole recording (WebM).

function download(blob, name) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

export const fileName = (title, ending) => `${title.replaceAll(/[^\w-]+/g, '_')}.${ending}`;

export async function savePicture(canvas, title, frame) {
  const blob = await new Promise((done) => canvas.toBlob(done, 'image/png'));
  download(blob, fileName(`${title} ${Math.floor(frame)}`, 'png'));
}

export const canSaveVideo = (canvas) => typeof MediaRecorder !== 'undefined' && typeof canvas.captureStream === 'function';

// Records from now on until stop() is called, then saves. 60 pictures a second.
export class VideoRecorder {
  constructor(canvas, title) {
    const type = ['video/webm;codecs=vp9', 'video/webm;codecs=vp8', 'video/webm'].find((each) => MediaRecorder.isTypeSupported(each));
    this.chunks = [];
    this.recorder = new MediaRecorder(canvas.captureStream(60), { mimeType: type, videoBitsPerSecond: 12e6 });
    this.recorder.addEventListener('dataavailable', ({ data }) => this.chunks.push(data));
    this.saved = new Promise((done) => this.recorder.addEventListener('stop', () => {
      const blob = new Blob(this.chunks, { type: 'video/webm' });
      download(blob, fileName(title, 'webm'));
      done(blob.size);
    }));
    this.recorder.start(250);
  }
  stop() {
    if (this.recorder.state !== 'inactive') this.recorder.stop();
    return this.saved;
  }
}
