import type { JsonObject } from "@culet/protocol/messages";
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import type { TierAngle } from "../session/answers";
import { ProblemError } from "../session/rest";
import { ListRequests, RETRY_MS, ReachRequests, STAY_MS } from "./tier-requests";
import type { ListTiers } from "./tiers";

const scene = (recut: JsonObject | null = null, more: JsonObject = {}): JsonObject => ({
  stones: [{ id: "a", cut: "brilliant", mesh: null, recut, ...more }],
});
const tier = (number: number): TierAngle => ({
  tier: number,
  names: [],
  facets: 8,
  side: "pavilion",
  degrees: 41,
  independent: true,
  least: 40,
  most: 42,
});
const BUSY = new ProblemError(503, "busy");

/** A server that answers when it is told to. */
class Server {
  readonly asked: { reach: string | null; signal: AbortSignal | undefined }[] = [];
  private readonly waiting: { give: (tiers: TierAngle[]) => void; refuse: (error: Error) => void }[] = [];
  readonly list: ListTiers = (_, reach, signal) => {
    this.asked.push({ reach, signal });
    return new Promise((give, refuse) => {
      this.waiting.push({ give, refuse });
      signal?.addEventListener("abort", () => refuse(new ProblemError(0, "given up")));
    });
  };

  async give(...tiers: TierAngle[]): Promise<void> {
    this.waiting.at(-1)?.give(tiers);
    await vi.advanceTimersByTimeAsync(0);
  }

  async refuse(error: Error): Promise<void> {
    this.waiting.at(-1)?.refuse(error);
    await vi.advanceTimersByTimeAsync(0);
  }
}

beforeEach(() => void vi.useFakeTimers());
afterEach(() => void vi.useRealTimers());

describe("the list of tiers", () => {
  const made = () => {
    const server = new Server();
    const hearer = { listed: vi.fn(), failed: vi.fn() };
    return { server, ...hearer, requests: new ListRequests(server.list, hearer) };
  };

  it("is asked for once at a time, while somebody looks, of the stone as it is then", async () => {
    const { server, listed, requests } = made();
    requests.look(scene(), false);
    expect(server.asked).toHaveLength(0);
    requests.look(scene(), true);
    for (const ratio of [1.1, 1.2, 1.3]) requests.look(scene({ crown_ratio: ratio }), true);
    expect(server.asked).toHaveLength(1);
    await server.give(tier(1));
    expect(listed).toHaveBeenLastCalledWith([tier(1)], scene());
    expect(server.asked).toHaveLength(2);
    await server.give(tier(2));
    expect(listed).toHaveBeenLastCalledWith([tier(2)], scene({ crown_ratio: 1.3 }));
    requests.look(scene({ crown_ratio: 1.3 }), true);
    expect(server.asked).toHaveLength(2);
  });

  it("is asked for again after a while where the server was busy, and not before", async () => {
    const { server, listed, failed, requests } = made();
    requests.look(scene(), true);
    await server.refuse(BUSY);
    expect(failed).toHaveBeenCalledWith(BUSY, scene());
    requests.look(scene({ crown_ratio: 1.1 }), true);
    vi.advanceTimersByTime(RETRY_MS - 1);
    expect(server.asked).toHaveLength(1);
    vi.advanceTimersByTime(1);
    expect(server.asked).toHaveLength(2);
    await server.give(tier(1));
    expect(listed).toHaveBeenCalledTimes(1);
    vi.advanceTimersByTime(2 * RETRY_MS);
    expect(server.asked).toHaveLength(2);
  });

  it("is not asked for again where the server has none, nor while nobody looks", async () => {
    const { server, failed, requests } = made();
    const none = new ProblemError(422, "expected a convex stone");
    requests.look(scene(), true);
    await server.refuse(none);
    expect(failed).toHaveBeenCalledWith(none, scene());
    vi.advanceTimersByTime(2 * RETRY_MS);
    expect(server.asked).toHaveLength(1);
    requests.look(scene({ crown_ratio: 1.1 }), true);
    await server.refuse(BUSY);
    requests.look(scene({ crown_ratio: 1.1 }), false);
    vi.advanceTimersByTime(2 * RETRY_MS);
    expect(server.asked).toHaveLength(2);
    requests.look(scene({ crown_ratio: 1.1 }), true);
    expect(server.asked).toHaveLength(3);
  });

  it("of a stone that has gone is told to nobody", async () => {
    const { server, listed, failed, requests } = made();
    requests.look(scene(), true);
    requests.look(scene(null, { id: "b" }), true);
    await server.give(tier(1));
    expect(server.asked).toHaveLength(2);
    requests.look(scene(), true);
    await server.refuse(new Error("expected a convex stone"));
    expect([listed, failed].map(({ mock }) => mock.calls.length)).toEqual([0, 0]);
    await server.give(tier(3));
    expect(listed.mock.calls).toEqual([[[tier(3)], scene()]]);
    requests.look(scene(null, { id: "b" }), false);
    requests.look(scene(), true); // who showed its list has forgotten it
    expect(server.asked).toHaveLength(4);
  });
});

describe("the ends at which meets are kept", () => {
  const made = () => {
    const server = new Server();
    const reached = vi.fn();
    const requests = new ReachRequests(server.list, reached);
    requests.look(scene());
    return { server, reached, requests, asked: () => server.asked.map(({ reach }) => reach) };
  };

  it("are asked for where a pointer stays, and not where it passes", async () => {
    const { server, reached, requests, asked } = made();
    for (const passed of ["1", "2"]) {
      requests.use("pointer", passed);
      vi.advanceTimersByTime(STAY_MS - 1);
      requests.use("pointer", null);
    }
    requests.use("pointer", "3");
    vi.advanceTimersByTime(STAY_MS);
    expect(asked()).toEqual(["3"]);
    expect(requests.ends("3")).toBeNull();
    await server.give(tier(2), tier(3));
    expect(reached.mock.calls).toEqual([["3"]]);
    expect(requests.ends("3")).toEqual(tier(3));
    requests.use("pointer", null);
    requests.use("pointer", "3");
    vi.advanceTimersByTime(STAY_MS);
    expect(asked()).toEqual(["3"]);
  });

  it("are asked for of one tier at a time, and given up where nobody waits for them", async () => {
    const { server, reached, requests, asked } = made();
    requests.use("focus", "1");
    vi.advanceTimersByTime(STAY_MS);
    requests.use("pointer", "2");
    vi.advanceTimersByTime(STAY_MS);
    expect(asked()).toEqual(["1"]);
    await server.give(tier(1));
    vi.advanceTimersByTime(STAY_MS);
    expect(asked()).toEqual(["1", "2"]);
    requests.use("pointer", "3");
    expect(server.asked[1]?.signal?.aborted).toBe(true);
    vi.advanceTimersByTime(STAY_MS);
    await server.give(tier(3));
    expect(asked()).toEqual(["1", "2", "3"]);
    expect(reached.mock.calls).toEqual([["1"], ["3"]]);
  });

  it("are of the other tiers as they are", async () => {
    const { server, requests, asked } = made();
    requests.use("focus", "1");
    vi.advanceTimersByTime(STAY_MS);
    requests.look(scene({ angles: { 2: 30 } }));
    expect(server.asked[0]?.signal?.aborted).toBe(true);
    vi.advanceTimersByTime(STAY_MS);
    await server.give(tier(1));
    requests.look(scene({ angles: { 1: 41, 2: 30 } }));
    expect(requests.ends("1")).toEqual(tier(1));
    vi.advanceTimersByTime(STAY_MS);
    expect(asked()).toEqual(["1", "1"]);
    requests.look(scene());
    expect(requests.ends("1")).toBeNull();
  });

  it("are asked for again where the server was busy, as long as somebody waits", async () => {
    const { server, requests, asked } = made();
    requests.use("focus", "1");
    vi.advanceTimersByTime(STAY_MS);
    await server.refuse(BUSY);
    vi.advanceTimersByTime(RETRY_MS);
    expect(asked()).toEqual(["1", "1"]);
    await server.refuse(BUSY);
    requests.use("focus", null);
    vi.advanceTimersByTime(2 * RETRY_MS);
    expect(asked()).toEqual(["1", "1"]);
    requests.use("focus", "2");
    vi.advanceTimersByTime(STAY_MS);
    await server.refuse(new ProblemError(422, "expected a tier of the stone"));
    vi.advanceTimersByTime(2 * RETRY_MS);
    expect(asked()).toEqual(["1", "1", "2"]);
  });
});
