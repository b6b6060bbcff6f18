import { defineConfig } from "vite";

/** `<culet-viewer>` as a package of its own, which the server also offers: element/ and the built script. */
export default defineConfig({
  publicDir: "element",
  build: {
    target: "es2022",
    outDir: "dist/element",
    lib: { entry: "src/element/culet-viewer.ts", formats: ["es"], fileName: "culet-viewer" },
  },
});
