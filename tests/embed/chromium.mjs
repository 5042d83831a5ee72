// Opens a page in Chromium without a window and prints what became of it, as `name value` lines:
//
//     node chromium.mjs URL SCREENSHOT.png [FILE]
//
// waits until the page says that it is done (`data-state` of its root), drops FILE on it, if there is one, and takes a picture.
// It speaks Chromium's DevTools protocol over a pipe.
import { spawn } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, join } from "node:path";

const [url, screenshot, file] = process.argv.slice(2);
const profile = mkdtempSync(join(tmpdir(), "etendue-chromium-"));
const flags = ["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--remote-debugging-pipe"];
const browser = spawn("chromium", [...flags, "--window-size=1280,800", `--user-data-dir=${profile}`], {
    stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"],
});
const [, , , input, output] = browser.stdio;

const answers = new Map();
const complaints = [];
let text = "";
output.on("data", (bytes) => {
    text += bytes;
    const messages = text.split("\0");
    text = messages.pop();
    for (const message of messages.map((m) => JSON.parse(m))) {
        answers.get(message.id)?.(message);
        if (message.method === "Runtime.exceptionThrown") {
            complaints.push(message.params.exceptionDetails.exception?.description ?? "an exception");
        }
    }
});

let count = 0;
function call(method, params, sessionId) {
    const id = ++count;
    input.write(`${JSON.stringify({ id, method, params, sessionId })}\0`);
    return new Promise((resolve, reject) => {
        answers.set(id, ({ result, error }) => (error ? reject(new Error(`${method}: ${error.message}`)) : resolve(result)));
    });
}

async function visit() {
    const { targetId } = await call("Target.createTarget", { url: "about:blank" });
    const { sessionId } = await call("Target.attachToTarget", { targetId, flatten: true });
    const evaluate = async (expression) => {
        const { result } = await call("Runtime.evaluate", { expression, returnByValue: true }, sessionId);
        return result.value;
    };
    const size = { width: 1280, height: 800, deviceScaleFactor: 1, mobile: false };
    await call("Emulation.setDeviceMetricsOverride", size, sessionId);
    await call("Runtime.enable", {}, sessionId);
    await call("Page.navigate", { url }, sessionId);
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
    const { data } = await call("Page.captureScreenshot", { format: "png" }, sessionId);
    writeFileSync(screenshot, Buffer.from(data, "base64"));
    const state = await evaluate("JSON.stringify(document.documentElement.dataset)");
    return { ...JSON.parse(state), error: await evaluate(shown) };
}

try {
    for (const [name, value] of Object.entries(await visit())) {
        console.log(`${name} ${value}`);
    }
    complaints.forEach((complaint) => console.log(`exception ${complaint}`));
} finally {
    await new Promise((resolve) => {
        browser.on("exit", resolve);
        call("Browser.close").catch(() => browser.kill());
    });
    rmSync(profile, { recursive: true, force: true, maxRetries: 5 });
}
