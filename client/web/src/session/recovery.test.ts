import { beforeEach, describe, expect, it } from "vitest";
import { lacksFile, OpenedFiles, recover, type Server } from "./recovery";
import { type Lost, ProblemError } from "./rest";

const MESH = "ab".repeat(16);
const SKY = "cd".repeat(16);
const lost: Lost = {
  id: "0".repeat(32),
  scene: { stones: [{ mesh: MESH }], environment: { kind: "image", image: SKY } },
  snapshot: { step: 7 },
};
const lacking = new ProblemError(422, "no such mesh", "scene.stones.0.mesh");

describe("a session that the server has lost", () => {
  let asked: Lost[];
  let given: string[];
  let found: string[];
  let missing: ProblemError | null;
  let files: OpenedFiles;

  beforeEach(() => {
    asked = [];
    given = [];
    found = [];
    missing = null;
    files = new OpenedFiles();
  });

  const give = async (file: File) => {
    given.push(file.name);
    return { id: "", findings: [] };
  };
  const server = (...refusals: (ProblemError | null)[]): Server => ({
    reopen: async (what) => {
      asked.push(what);
      const refusal = refusals.shift();
      if (refusal) throw refusal;
    },
    find: async (id) => {
      found.push(id);
      if (missing) throw missing;
    },
  });

  it("is made again from what the page knows", async () => {
    expect(await recover(lost, files, server(null))).toBe(true);
    expect(asked).toEqual([lost]);
    expect(found).toEqual([]);
  });

  it("gets the files again that its scene names, and no others", async () => {
    files.keep(MESH, new File([], "stone.obj"), give);
    files.keep(SKY, new File([], "sky.hdr"), give);
    files.keep("ef".repeat(16), new File([], "other.obj"), give);
    await recover(lost, files, server(lacking, null));
    expect(asked).toEqual([lost, lost]);
    expect(given.sort()).toEqual(["sky.hdr", "stone.obj"]);
  });

  it("begins with its scene alone, if its snapshot is of another version", async () => {
    files.keep(MESH, new File([], "stone.obj"), give);
    const foreign = new ProblemError(422, "expected a snapshot of solver version 4", "snapshot.contacts");
    expect(await recover(lost, files, server(foreign, lacking, null))).toBe(true);
    const still = { ...lost, snapshot: null };
    expect(asked).toEqual([lost, still, still]);
    await expect(recover(still, files, server(foreign))).rejects.toBe(foreign);
  });

  it("is waited for, where only others may make it again", async () => {
    const tokenless = new ProblemError(401, "expected this server's token");
    expect(await recover(lost, files, server(tokenless))).toBe(false);
    expect(found).toEqual([lost.id]);
    missing = new ProblemError(404, "no such session");
    await expect(recover(lost, files, server(tokenless))).rejects.toBe(missing);
  });

  it("stays lost, with the reason, if its files are not here", async () => {
    await expect(recover(lost, files, server(lacking))).rejects.toBe(lacking);
    expect(asked).toHaveLength(1);
  });

  it("stays lost if it is refused for another reason", async () => {
    files.keep(MESH, new File([], "stone.obj"), give);
    const busy = new ProblemError(429, "at the limit");
    await expect(recover(lost, files, server(busy))).rejects.toBe(busy);
    expect(given).toEqual([]);
  });

  it("lacks a file if the field says so", () => {
    expect(lacksFile(lacking)).toBe(true);
    expect(lacksFile(new ProblemError(422, "", "environment.image"))).toBe(true);
    expect(lacksFile(new ProblemError(422, "", "stones.0.cut"))).toBe(false);
    expect(lacksFile(new ProblemError(422, ""))).toBe(false);
    expect(lacksFile(new ProblemError(404, "", "mesh"))).toBe(false);
  });
});
