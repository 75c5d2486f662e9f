// Contact sheets of recordings: node gallery.mjs RECORDINGS OUTPUT TITLE=scene,scene,... [...]. RECORDINGS is a folder of pages
// that the runner wrote; each sheet becomes OUTPUT/TITLE.jpg. Called by ./fulcrum gallery. CHROMIUM names the browser.
import { existsSync, mkdirSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { launch } from './test/browser.mjs';

const COLUMNS = 4, WIDTH = 400, HEIGHT = 260; // of a picture, CSS pixels
const QUALITY = 72;
const LONGEST_LOAD = 900000; // ms, software draws the large scenes, on a busy machine

const [recordings, output, ...sheets] = process.argv.slice(2);
if (sheets.length === 0) {
  console.error('usage: node gallery.mjs RECORDINGS OUTPUT TITLE=scene,scene,... [...]');
  process.exit(2);
}

// The picture that the scene chose, without texts and controls.
async function pictureOf(browser, scene) {
  const html = join(recordings, `${scene}.html`);
  if (!existsSync(html)) throw new Error(`${html} is missing`);
  const page = await browser.newPage({ viewport: { width: WIDTH, height: HEIGHT }, deviceScaleFactor: 1.5 });
  page.setDefaultTimeout(LONGEST_LOAD);
  const complaints = [];
  page.on('pageerror', (error) => complaints.push(error.message));
  page.on('console', (message) => message.type() === 'error' && complaints.push(message.text()));
  await page.goto(`${pathToFileURL(resolve(html))}#bare=1&frame=picture&fit=1.2&occlusion=1`);
  await page.waitForFunction(() => window.fulcrum || document.getElementById('message').textContent.startsWith('This recording cannot'));
  await page.evaluate(() => window.fulcrum?.settle());
  const image = await page.screenshot({ type: 'png', timeout: LONGEST_LOAD });
  await page.close();
  if (complaints.length > 0) throw new Error(`${scene}: ${complaints.join('; ')}`);
  return image;
}

const sheetPage = (pictures) => `<!doctype html><style>
  body { margin: 0; padding: 6px; width: ${COLUMNS * (WIDTH + 6)}px; display: grid; grid-template-columns: repeat(${COLUMNS}, ${WIDTH}px); gap: 6px;
    background: #fff; font: 600 14px/1.2 "DejaVu Sans", sans-serif; color: #16202b; }
  figure { margin: 0; }
  img { width: 100%; height: ${HEIGHT}px; display: block; border-radius: 6px; }
  figcaption { padding: 3px 4px 6px; }
</style>${pictures.map(({ scene, image }) => `<figure><img src="data:image/png;base64,${image.toString('base64')}"><figcaption>${scene}</figcaption></figure>`).join('')}`;

mkdirSync(output, { recursive: true });
const browser = await launch();
let failed = 0;
try {
  for (const sheet of sheets) {
    const [title, list] = sheet.split('=');
    const pictures = [];
    for (const scene of list.split(',')) {
      process.stderr.write(`${title}: ${scene}\n`);
      try {
        pictures.push({ scene, image: await pictureOf(browser, scene) });
      } catch (error) {
        console.error(`gallery: ${error.message}`);
        ++failed;
      }
    }
    const page = await browser.newPage({ viewport: { width: COLUMNS * (WIDTH + 6) + 12, height: 400 } });
    await page.setContent(sheetPage(pictures));
    await page.screenshot({ type: 'jpeg', quality: QUALITY, fullPage: true, path: join(output, `${title}.jpg`) });
    await page.close();
    console.log(join(output, `${title}.jpg`));
  }
} finally {
  await browser.close();
}
process.exit(failed > 0 ? 1 : 0);
