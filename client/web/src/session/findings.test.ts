import { afterEach, beforeEach, expect, it, vi } from "vitest";
import { Findings, PAUSE_MS } from "./findings";

const OVERLAP = "the stones 'a' and 'b' overlap";

beforeEach(() => {
  vi.useFakeTimers();
});
afterEach(() => {
  vi.useRealTimers();
});

function listening(answers: (string[] | Error)[]) {
  const told: string[] = [];
  const asked = vi.fn(async () => {
    const answer = answers.shift() ?? [];
    if (answer instanceof Error) throw answer;
    return answer;
  });
  return { told, asked, findings: new Findings(asked, (text) => told.push(text)) };
}

async function changed(findings: Findings): Promise<void> {
  findings.changed();
  await vi.advanceTimersByTimeAsync(PAUSE_MS);
}

it("many changes in a row are one question, after the last of them", async () => {
  const { asked, findings } = listening([]);
  for (let change = 0; change < 5; change++) {
    findings.changed();
    await vi.advanceTimersByTimeAsync(PAUSE_MS / 2);
  }
  expect(asked).not.toHaveBeenCalled();
  await vi.advanceTimersByTimeAsync(PAUSE_MS);
  expect(asked).toHaveBeenCalledTimes(1);
});

it("what is found is told once, and again when it has gone and comes back", async () => {
  const { told, findings } = listening([[OVERLAP], [OVERLAP, "more"], [], [OVERLAP]]);
  await changed(findings);
  expect(told).toEqual([OVERLAP]);
  await changed(findings);
  expect(told).toEqual([OVERLAP, "more"]);
  await changed(findings);
  await changed(findings);
  expect(told).toEqual([OVERLAP, "more", OVERLAP]);
});

it("a server that cannot be asked is no finding, and is asked again after the next change", async () => {
  const { told, findings } = listening([new Error("gone"), [OVERLAP]]);
  await changed(findings);
  expect(told).toEqual([]);
  await changed(findings);
  expect(told).toEqual([OVERLAP]);
});
