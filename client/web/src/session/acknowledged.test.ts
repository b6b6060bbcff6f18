import { afterEach, beforeEach, expect, it, vi } from "vitest";
import { Acknowledged } from "./acknowledged";

beforeEach(() => void vi.useFakeTimers());
afterEach(() => void vi.useRealTimers());

/** A stream, and what was heard of each that waits. */
function waiting() {
  const sent = { connection: 1, count: 7 };
  const asked: { number: number; message: number }[] = [];
  const acknowledged = new Acknowledged(
    ({ number }) => asked.push({ number, message: ++sent.count }),
    () => ({ ...sent }),
  );
  const told: [string, string | null][] = [];
  const after = (name: string, messages: number) =>
    void acknowledged
      .after(() => {
        sent.count += messages;
      })
      .then((why) => told.push([name, why]));
  const problem = (code: string, number: number) =>
    acknowledged.refused({ type: "problem", code, message: `${code} of ${number}`, number });
  return { sent, asked, acknowledged, told, after, problem };
}

const settle = () => vi.advanceTimersByTimeAsync(0);

it("ends to wait with the answer to its own question, or when none will come", async () => {
  const { asked, acknowledged, told, after } = waiting();
  after("first", 1);
  after("second", 2);
  const [first, second] = asked;
  if (first === undefined || second === undefined) throw new Error("expected two questions");
  acknowledged.heard({ type: "reached", number: 1, step: 4 }); // somebody else's
  acknowledged.heard({ type: "reached", number: second.number, step: 4 });
  await settle();
  expect(told).toEqual([["second", null]]);
  expect(vi.getTimerCount()).toBe(1);
  await vi.runAllTimersAsync();
  expect(told[1]).toEqual(["first", "The server did not answer."]);
});

it("is told why its own messages were given up, and of no others", async () => {
  const { sent, asked, acknowledged, told, after, problem } = waiting();
  after("slider", 2); // the messages 8 and 9, and 10 is the question
  expect(asked[0]?.message).toBe(10);
  expect(problem("at_the_limit", 7)).toBe(false);
  expect(problem("at_the_limit", 11)).toBe(false);
  expect(problem("unusable_input", 9)).toBe(false); // which no other try would mend
  expect(problem("at_the_limit", 8)).toBe(true);
  expect(problem("at_the_limit", 9)).toBe(true); // the first reason is told
  await settle();
  expect(told).toEqual([]); // the others may be under way
  acknowledged.heard({ type: "reached", number: asked[0]?.number ?? 0, step: 4 });
  await settle();
  expect(told).toEqual([["slider", "at_the_limit of 8"]]);
  after("another", 1);
  sent.connection = 2;
  sent.count = 0;
  expect(problem("at_the_limit", 11)).toBe(false); // of another connection
});

it("takes what its question was refused for as unknown", async () => {
  const { told, after, problem } = waiting();
  after("slider", 1);
  expect(problem("engine_unavailable", 9)).toBe(true);
  after("refused", 1);
  expect(problem("unusable_input", 11)).toBe(false);
  await settle();
  expect(told).toEqual([
    ["slider", "engine_unavailable of 9"],
    ["refused", null],
  ]);
});

it("waits for nothing where nothing could be sent, which is not sent later either", async () => {
  const { asked, told, after } = waiting();
  after("without a connection", 0);
  await settle();
  expect(told).toEqual([["without a connection", null]]);
  expect(asked).toEqual([]);
  expect(vi.getTimerCount()).toBe(0);
});
