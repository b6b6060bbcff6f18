import { describe, expect, it } from "vitest";
import { words } from "../words/words";
import { gradedBy, reportOf, type TiltColumns, tiltText } from "./grades";

const number = (value: number) => ({ value, error: 0.034, bound: 0.004 });
const ANSWER = {
  grades: {
    iso: number(79.14),
    cos: number(60),
    sc2: number(58),
    contrast: number(24),
    fire: number(55),
    window: number(0),
    extinction: number(0),
    shares: { leak: number(7.1), red: number(50), green: number(6), blue: number(19) },
  },
  weighted_light_return: number(0.2784),
  size: { length: 9.1, width: 6.504, depth: 4, carats: 1.5312, density: 3520 },
  tilt: null,
};

describe("a report", () => {
  it("has a line for each grade, with how sure it is", () => {
    const { lines } = reportOf(ANSWER);
    expect(lines.map(({ name }) => name)).toEqual(Object.values(words.grades.lines).map(([label]) => label));
    expect(lines[0]?.value).toBe("79.1 %");
    expect(lines[0]?.error).toBe("\u00b1 0.03");
    expect(lines[0]?.hint).toContain("0.03");
    expect(lines.at(-1)?.value).toBe("0.278");
  });

  it("tells how far each grade is from another design's", () => {
    const other = { ...ANSWER, grades: { ...ANSWER.grades, iso: number(80.5), fire: number(50) } };
    const lines = reportOf(ANSWER, other).lines;
    expect(lines[0]?.difference).toBe("\u22121.4");
    expect(lines[4]?.difference).toBe("+5.0");
    expect(lines.at(-1)?.difference).toBe("+0.000");
    expect(reportOf(ANSWER).lines[0]?.difference).toBeNull();
  });

  it("tells millimetres and carats", () => {
    expect(reportOf(ANSWER).size).toBe("9.10 \u00d7 6.50 \u00d7 4.00 mm, 1.53 ct");
  });

  it("has curves about both axes where they were asked for", () => {
    const point = (degrees: number, value: number) => ({ degrees, iso: number(value) });
    const tilt = { x: [point(-5, 70), point(0, 79)], z: [point(-5, 71), point(0, 79)] };
    expect(reportOf(ANSWER).tilt).toBeNull();
    expect(reportOf({ ...ANSWER, tilt }).tilt).toEqual([
      [-5, 0],
      [70, 79],
      [71, 79],
    ]);
  });
});

it("curves are told by their middle and by usual tilts", () => {
  const columns: TiltColumns = [
    [-30, -5, 0, 30],
    [50, 70, 79, 55.04],
    [51, 71, 79, 56],
  ];
  const [first, second] = words.grades.axes;
  expect(tiltText(columns)).toBe(
    `${first}: 50.0 % at -30\u00b0, 79.0 % at 0\u00b0, 55.0 % at 30\u00b0. ` +
      `${second}: 51.0 % at -30\u00b0, 79.0 % at 0\u00b0, 56.0 % at 30\u00b0.`,
  );
});

describe("what grades depend on", () => {
  const scene = { millimetres: 3, stones: [{ id: "a", cut: "oval", material: "diamond", position: [0, 0, 0] }] };

  it("is the shape, the material and the size, not where the stone is", () => {
    const [stone] = scene.stones;
    expect(gradedBy({ ...scene, stones: [{ ...stone, position: [1, 2, 3] }] })).toBe(gradedBy(scene));
    expect(gradedBy({ ...scene, stones: [{ ...stone, cut: "pear" }] })).not.toBe(gradedBy(scene));
    expect(gradedBy({ ...scene, millimetres: 4 })).not.toBe(gradedBy(scene));
  });

  it("is nothing without a stone", () => {
    expect(gradedBy(null)).toBe("");
    expect(gradedBy({ stones: [] })).toBe("");
  });
});
