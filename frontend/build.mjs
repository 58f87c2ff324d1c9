// Bundles the page into ../src/crowdbot/assets/web. `--check` compares with the files there and writes nothing.
import { build } from "esbuild";
import { existsSync, mkdirSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const out = join(here, "..", "src", "crowdbot", "assets", "web");

async function bundle(entry, options = {}) {
  const result = await build({
    entryPoints: [join(here, entry)],
    bundle: true,
    minify: true,
    format: "esm",
    target: "es2022",
    legalComments: "none",
    write: false,
    absWorkingDir: here,
    ...options,
  });
  return result.outputFiles[0].text;
}

function licenses() {
  const { dependencies } = JSON.parse(readFileSync(join(here, "package.json"), "utf8"));
  const texts = Object.keys(dependencies).sort().map((name) => {
    const folder = join(here, "node_modules", name);
    const { version, license } = JSON.parse(readFileSync(join(folder, "package.json"), "utf8"));
    const file = readdirSync(folder).find((one) => /^licen[cs]e/i.test(one));
    if (!file) throw new Error(`${name} has no licence file`);
    return `${name} ${version} (${license})\n\n${readFileSync(join(folder, file), "utf8").trim()}\n`;
  });
  return `app.js, player.js and vr.js contain these libraries.\n\n${texts.join("\n" + "-".repeat(80) + "\n\n")}`;
}

const files = {
  "app.js": await bundle("src/main.mjs"),
  "app.css": await bundle("src/styles/app.css"),
  "index.html": readFileSync(join(here, "src", "index.html"), "utf8"),
  "icon.svg": readFileSync(join(here, "src", "icon.svg"), "utf8"),
  "player.js": await bundle("src/player/main.mjs"),
  "player.css": await bundle("src/styles/player.css"),
  "player.html": readFileSync(join(here, "src", "player.html"), "utf8"),
  "vr.js": await bundle("src/vr/main.mjs"),
  "vr.css": await bundle("src/styles/vr.css"),
  "vr.html": readFileSync(join(here, "src", "vr.html"), "utf8"),
  "licenses.txt": licenses(),
};

const stale = Object.keys(files).filter(
  (name) => !existsSync(join(out, name)) || readFileSync(join(out, name), "utf8") !== files[name],
);
if (process.argv.includes("--check")) {
  if (stale.length) {
    console.error(`not as built: ${stale.join(", ")}; run: cd frontend && npm ci && npm run build`);
    process.exit(1);
  }
  console.log("the files of the page are as built");
} else {
  mkdirSync(out, { recursive: true });
  for (const name of stale) writeFileSync(join(out, name), files[name]);
  for (const name of Object.keys(files)) console.log(`${name} ${Buffer.byteLength(files[name])} bytes`);
}
