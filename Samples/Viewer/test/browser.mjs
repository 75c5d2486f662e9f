// Headless Chromium and pages in it that tell how their picture changes. CHROMIUM names the browser, /usr/bin/chromium by
// default.
import { pathToFileURL } from 'node:url';
import { chromium } from 'playwright-core';

const ARGUMENTS = [
  '--no-sandbox', '--no-first-run', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
  '--disable-background-networking', '--disable-component-update', '--disable-sync',
];

// ms; waits end with what they wait for: only a page that hangs takes as long, not one that software draws on a busy machine.
const LONGEST_WAIT = 600000;

export const launch = () => chromium.launch({ executablePath: process.env.CHROMIUM || '/usr/bin/chromium', args: ARGUMENTS });

export async function newPage(browser, options) {
  const page = await browser.newPage(options);
  page.context().setDefaultTimeout(LONGEST_WAIT);
  return page;
}

// The page of a recording, at its first frame. What it complains of and what it asks for are added to the two lists. `settings`: more
// of its address.
export async function openPage(browser, html, complaints = [], requests = [], settings = '') {
  const page = await newPage(browser, { viewport: { width: 640, height: 360 } }); // small: software draws it
  page.on('console', (message) => ['error', 'warning'].includes(message.type()) && complaints.push(message.text()));
  page.on('pageerror', (error) => complaints.push(error.message));
  page.on('request', (request) => requests.push(request.url()));
  await page.goto(`${pathToFileURL(html)}#frame=0&${settings}`);
  await page.waitForFunction(() => window.fulcrum);
  await page.evaluate(() => {
    // The page draws with the browser's next picture; the one after that has it.
    window.drawn = () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
    window.pictureNow = () => {
      const source = document.getElementById('canvas');
      const copy = Object.assign(document.createElement('canvas'), { width: source.width, height: source.height });
      const context = copy.getContext('2d', { willReadFrequently: true });
      context.drawImage(source, 0, 0);
      return context.getImageData(0, 0, copy.width, copy.height).data;
    };
    window.keepPicture = async () => {
      await window.drawn();
      window.kept = window.pictureNow();
    };
    // The share of pixels that differ clearly from those of the kept picture.
    window.differenceToKept = async () => {
      await window.drawn();
      const now = window.pictureNow();
      let count = 0;
      for (let i = 0; i < now.length; i += 4) {
        const off = Math.abs(now[i] - window.kept[i]) + Math.abs(now[i + 1] - window.kept[i + 1]) + Math.abs(now[i + 2] - window.kept[i + 2]);
        if (off > 24) ++count;
      }
      return count / (now.length / 4);
    };
  });
  return page;
}
