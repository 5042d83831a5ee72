// How a page of one file lies in windows of some widths, as a line of JSON for each, and a picture of the whole page:
//
//     node layout.mjs URL WIDTH SCREENSHOT.png [WIDTH SCREENSHOT.png …]
import { writeFileSync } from "node:fs";
import { browse } from "./devtools.mjs";

const [url, ...windows] = process.argv.slice(2);

await browse(async ({ call, evaluate, complaints }) => {
    const resize = (width, height) =>
        call("Emulation.setDeviceMetricsOverride", { width, height, deviceScaleFactor: 1, mobile: false });
    await resize(1280, 800);
    await call("Page.navigate", { url });
    for (let tries = 0; tries < 300 && (await evaluate("document.readyState")) !== "complete"; tries++) {
        await new Promise((resolve) => setTimeout(resolve, 100));
    }
    await evaluate("Promise.all([...document.images].map((image) => image.decode().catch(() => {})))");
    for (let i = 0; i < windows.length; i += 2) {
        await resize(Number(windows[i]), 800);
        const layout = await evaluate(`(() => {
            const root = document.documentElement;
            const boxes = [...document.querySelectorAll("figure svg, figure img")].map((e) => {
                const { left, right, width, height } = e.getBoundingClientRect();
                const loaded = e.tagName === "IMG" ? e.naturalWidth : e.childElementCount;
                return { what: e.tagName.toLowerCase(), left, right, width, height, loaded };
            });
            return { window: innerWidth, width: root.clientWidth, scrolls: root.scrollWidth, height: root.scrollHeight, boxes };
        })()`);
        console.log(JSON.stringify({ ...layout, complaints }));
        await resize(Number(windows[i]), layout.height);
        const { data } = await call("Page.captureScreenshot", { format: "png" });
        writeFileSync(windows[i + 1], Buffer.from(data, "base64"));
    }
});
