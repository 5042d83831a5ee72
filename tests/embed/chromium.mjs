// Opens a page in Chromium without a window and prints what became of it, as `name value` lines:
//
//     node chromium.mjs URL SCREENSHOT.png [FILE]
//
// waits until the page says that it is done (`data-state` of its root), drops FILE on it, if there is one, and takes a picture.
import { readFileSync, writeFileSync } from "node:fs";
import { basename } from "node:path";
import { browse } from "./devtools.mjs";

const [url, screenshot, file] = process.argv.slice(2);

await browse(async ({ call, evaluate, complaints }) => {
    const size = { width: 1280, height: 800, deviceScaleFactor: 1, mobile: false };
    await call("Emulation.setDeviceMetricsOverride", size);
    await call("Page.navigate", { url });
    const shown = "(document.getElementById('error')?.textContent ?? '')";
    const until = async (condition) => {
        for (let tries = 0; tries < 3000 && complaints.length === 0 && !(await evaluate(condition)); tries++) {
            await new Promise((resolve) => setTimeout(resolve, 100));
        }
    };
    await until(`document.documentElement.dataset.state === "done" || ${shown} !== ""`);
    if (file) {
        const bytes = JSON.stringify([...readFileSync(file)]);
        await evaluate(`{
            const dataTransfer = new DataTransfer();
            dataTransfer.items.add(new File([new Uint8Array(${bytes})], ${JSON.stringify(basename(file))}));
            document.body.dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true }));
        }`);
        await until(`${shown} !== ""`);
    }
    const { data } = await call("Page.captureScreenshot", { format: "png" });
    writeFileSync(screenshot, Buffer.from(data, "base64"));
    const state = JSON.parse(await evaluate("JSON.stringify(document.documentElement.dataset)"));
    for (const [name, value] of Object.entries({ ...state, error: await evaluate(shown) })) {
        console.log(`${name} ${value}`);
    }
    complaints.forEach((complaint) => console.log(`exception ${complaint}`));
});
