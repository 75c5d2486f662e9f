// What pages of recordings ask of a browser: node pagecost.mjs PAGE.html [...]. For each: megabytes; processor time of the main thread
// until it can be seen, and for a frame while it plays; draw calls and triangles of a frame, the most. The GPU's
// time is not in it: here software draws. CHROMIUM names the browser.
import { statSync } from 'node:fs';
import { basename, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { launch, newPage } from './test/browser.mjs';

const FRAMES = 30, WIDTH = 1280, HEIGHT = 720;

const pages = process.argv.slice(2);
if (pages.length === 0) {
  console.error('usage: node pagecost.mjs PAGE.html [...]');
  process.exit(2);
}
const browser = await launch();
console.log('| page | MB | load, ms | a frame, ms | draw calls | triangles |\n| --- | --- | --- | --- | --- | --- |');
for (const file of pages) {
  const page = await newPage(browser, { viewport: { width: WIDTH, height: HEIGHT } });
  const session = await page.context().newCDPSession(page);
  await session.send('Performance.enable', { timeDomain: 'threadTicks' });
  const taken = async () => (await session.send('Performance.getMetrics')).metrics.find(({ name }) => name === 'TaskDuration').value;
  await page.goto(`${pathToFileURL(resolve(file))}#frame=0&theme=light`);
  await page.waitForFunction(() => window.fulcrum);
  const load = await taken();
  const most = await page.evaluate((frames) => {
    const { fulcrum } = window, found = { calls: 0, triangles: 0 };
    for (let i = 0; i < frames; ++i) {
      fulcrum.seek(Math.max(0, Math.floor((fulcrum.frameCount - frames) / 2)) + i);
      found.calls = Math.max(found.calls, fulcrum.drawn.calls);
      found.triangles = Math.max(found.triangles, fulcrum.drawn.triangles);
    }
    return found;
  }, FRAMES);
  const frame = ((await taken()) - load) / FRAMES;
  console.log(`| \`${basename(file, '.html')}\` | ${(statSync(file).size / 1e6).toFixed(1)} | ${Math.round(1000 * load)} | ${(1000 * frame).toFixed(1)} | ${most.calls} | ${most.triangles} |`);
  await page.close();
}
await browser.close();
