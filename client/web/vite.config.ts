import { fileURLToPath } from "node:url";
import { defineConfig } from "vitest/config";

const protocol = fileURLToPath(new URL("../../protocol/typescript", import.meta.url));
const server = "http://127.0.0.1:8000";

export default defineConfig({
  base: "./", // a proxy may have the page in a folder of its own
  resolve: { alias: { "@culet/protocol": protocol } },
  // Licences of what is bundled ask to be given on with it.
  build: {
    target: "es2022",
    modulePreload: { polyfill: false }, // browsers of that year have it
    license: { fileName: "licenses.md" },
    rolldownOptions: { input: { page: "index.html", docs: "docs/index.html" } },
  },
  // `npm run dev` serves the page with hot reload and passes the rest on to a running `culet serve`.
  server: { proxy: { "/openapi.json": server, "/api": { target: server, ws: true } } },
  test: { include: ["src/**/*.test.ts"], restoreMocks: true },
});
