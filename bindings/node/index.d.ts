// Types of packcell for Node.js. The fields of records are those of packcell.h, which says what
// they mean; handles are freed by close(), or when nobody has them any more.

// As in TypeScript's own esnext.disposable, which not everybody has.
declare global {
  interface SymbolConstructor { readonly dispose: unique symbol }
}

/** A call that the library refused, with its message. A value of a wrong type is a TypeError, a
 * number that its C type does not hold a RangeError. */
export class PackcellError extends Error {
  /** PKC_E_* */
  readonly status: number;
  /** "PKC_E_ARGUMENT" and the like */
  readonly code: string;
}

export interface Item { id: number; w: number; h: number; flags?: number }
export interface Placement { item: Required<Item>; x: number; y: number; rot: number }
export interface Queued { item: Required<Item>; arms: number; recognized: number }
export interface Action {
  op: number; item?: number; x?: number; y?: number; rot?: number; arm?: number;
}

declare class Handle {
  /** Frees the handle now. PKC_E_BUSY while a call on another thread uses it. */
  close(): void;
  /** close(), for `using`; where Node.js has Symbol.dispose. */
  [Symbol.dispose](): void;
  readonly closed: boolean;
}

export interface BinInfo {
  w: number; h: number; items: number; occupied_cells: number; fixed_cells: number; hash: bigint;
}

export class Bin extends Handle {
  /** Cells, each side 1..128. */
  constructor(w: number, h: number);
  clone(): Bin;
  clear(): void;
  block(x: number, y: number, w: number, h: number): void;
  pack(item: Item, x: number, y: number, rot?: number): void;
  unpack(id: number): Placement;
  info(): BinInfo;
  items(): Placement[];
  /** W*H cells by x + y*W: an item's id, PKC_CELL_FREE or PKC_CELL_FIXED. */
  cells(): Int32Array;
  /** W*H + 1: 1 where the top-left corner may lie; the last is "no position". */
  feasible(w: number, h: number): Uint8Array;
  contact(x: number, y: number, w: number, h: number): number;
}

export interface ScenarioFields {
  robots?: number; recognized?: number; accessible?: number; overlap?: number;
}

export class Scenario {
  constructor(fields?: string | ScenarioFields);
  robots: number;
  recognized: number;
  accessible: number;
  overlap: number;
  /** "D-R5A3O1" */
  toString(): string;
}

export interface QueueInfo {
  belt: number; buffered: number; k_alpha: number; k_shared: number; k_beta: number;
  alpha_left: number;
}

export class Queue extends Handle {
  constructor(scenario: Scenario | string);
  clone(): Queue;
  push(item: Item): void;
  remove(id: number): void;
  removeItems(ids: ArrayLike<number>): void;
  putInBuffer(item: Item, arm: number): void;
  setAlphaLeft(alphaLeft: number): void;
  scenario(): Scenario;
  info(): QueueInfo;
  belt(): Queued[];
  buffer(): Queued[];
}

/** Carries out one step's actions, all or nothing. */
export function apply(bin: Bin, queue: Queue, actions: Action[]): void;
export function planHash(actions: Action[]): bigint;
export function saveSnapshot(bin: Bin, queue: Queue): Uint8Array;
export function loadSnapshot(snapshot: Uint8Array): { bin: Bin; queue: Queue };

export interface PolicyInfo {
  architecture: number; bin_w: number; bin_h: number; parameters: number; seed: bigint;
  steps: number; reward_fill: number; utilization: number; learner: string;
}

/** Immutable. */
export class Policy extends Handle {
  /** "default" unless said otherwise. */
  constructor(name?: string);
  static builtins(): string[];
  static load(blob: Uint8Array): Policy;
  static loadFile(path: string): Policy;
  save(): Uint8Array;
  saveFile(path: string): void;
  readonly name: string;
  info(): PolicyInfo;
  /** The position x + y*W; W*H is "no position". */
  select(bin: Bin, w: number, h: number): number;
  evaluate(bin: Bin, w: number, h: number): {
    logits: Float32Array; probabilities: Float32Array; value: number;
  };
  selectBatch(pairs: Array<[Bin, number, number]>): Int32Array;
  evaluateBatch(pairs: Array<[Bin, number, number]>): {
    positions: Int32Array; probabilities: Float32Array; values: Float32Array;
  };
  /** Mean utilisation, 0..1, of so many `bins` (1000) of a held-out stream by `seed` (1), and half
   * the width of its 95 % interval. Bins, items and rotation are those of the options. */
  measure(options?: TrainerOptions | null,
    stream?: { seed?: number | bigint; bins?: number | bigint }):
    { mean: number; half_width: number };
}

/** What is not given is the library's default. */
export interface TrainerOptions {
  learner?: number; architecture?: number; bin_w?: number; bin_h?: number; least_side?: number;
  most_side?: number; items?: number; rotation?: number; workers?: number; environments?: number;
  steps?: number; channels?: number; features?: number; hidden?: number; seed?: number | bigint;
  anneal?: number | bigint; gamma?: number; learning_rate?: number; entropy?: number;
  value_weight?: number; clip?: number; reward_fill?: number; name?: string;
}

export interface PlannerOptions {
  method?: number; rotation?: number; repack?: number; select?: number; buffer_capacity?: number;
  skip?: number; max_side?: number; max_items?: number; max_known?: number;
  memory?: number | bigint;
}
export interface Budget { nodes?: number | bigint; milliseconds?: number }
export interface PlanInfo {
  actions: number; packs: number; unpacks: number; repacked: number; terminate: number;
  proof: number; cancelled: number; utilization: number; score: number; nodes: number;
  tree_nodes: number; hash: bigint; milliseconds: number; repack_milliseconds: number;
}
export interface Plan { info: PlanInfo; actions: Required<Action>[] }

export class Planner extends Handle {
  constructor(options?: PlannerOptions | null, policy?: Policy | null);
  plan(bin: Bin, queue: Queue, budget?: Budget): Plan;
  /** On another thread. Until the promise is settled the planner, and it alone, is in use. */
  planAsync(bin: Bin, queue: Queue, budget?: Budget): Promise<Plan>;
  begin(bin: Bin, queue: Queue, budget?: Budget): void;
  /** Spends up to so many nodes; true when nothing is left to do. */
  step(nodes: number | bigint): boolean;
  result(): Plan;
  /** The plan being made ends with the best so far. */
  cancel(): void;
}

export interface PackingOptions { rotation?: boolean; budget?: Budget }
export function exactPack(bin: Bin, items: Item[], options?: PackingOptions): {
  answer: 'found' | 'impossible' | 'budget'; placements: Placement[] | null; nodes: number;
};
export function boundInOrder(bin: Bin, items: Item[], options?: PackingOptions): {
  count: number; exact: boolean;
};

export interface CellInfo {
  arms: number; bin_w: number; bin_h: number; buffer_slots: number[]; joints: number[];
  margin: number; tick: number; cycle: number; name: string;
}
export interface LayoutOptions { evaluations?: number; range?: number }
export interface LayoutInfo { evaluations: number; before: number; after: number }

/** Immutable; metres, radians and seconds. */
export class Cell extends Handle {
  constructor(preset: string);
  static presets(): string[];
  static load(json: string): Cell;
  static loadFile(path: string): Cell;
  save(): string;
  saveFile(path: string): void;
  info(): CellInfo;
  check(scenario: Scenario | string): void;
  /** `pose`: x, y, z and yaw. */
  inverse(arm: number, pose: ArrayLike<number>): Float64Array;
  forward(arm: number, joints: ArrayLike<number>): Float64Array;
  optimizeLayout(scenario: Scenario | string, options?: LayoutOptions):
    { cell: Cell; info: LayoutInfo };
  /** The actions with the arms of packs from the belt named anew. */
  allocate(queue: Queue, actions: Action[]): Required<Action>[];
}

export interface ArmTimes { travel: number; strokes: number; grips: number; waits: number[] }
export interface ScheduleInfo {
  mode: number; taken: number; steps: number; makespan: number; lower_bound: number;
  released: number; belt: number; planning: number; min_clearance: number; arms: ArmTimes[];
  hash: bigint; nodes: number; milliseconds: number;
}
export interface ArmSample {
  position: number[]; velocity: number[]; acceleration: number[]; tool: number[]; held: number;
  item: number; step: number; activity: number; reason: number;
}

export class Schedule extends Handle {
  /** `mode`: PKC_MODE_COORDINATED unless said otherwise. */
  constructor(cell: Cell, scenario: Scenario | string, mode?: number);
  /** Bin and queue are those before the step. */
  addStep(bin: Bin, queue: Queue, actions: Action[]): void;
  putAside(item: number, time: number): void;
  info(): ScheduleInfo;
  sample(arm: number, time: number): ArmSample;
  simulate(options?: SimulationOptions): Simulation;
  /** `kind`: PKC_TRACE_*. */
  writeTrace(kind: number, path: string,
    options?: { simulation?: Simulation | null; period?: number }): void;
}

export interface SimulationOptions {
  hertz?: number; sigma?: number; sigma_yaw?: number; seed?: number | bigint; frames?: number;
}
export interface SimulationInfo {
  places: number; jams: number; misplaced: number; worst_error: number; worst_overlap: number;
  seconds: number; steps: number; detections: number; missed: number; hash: bigint;
  milliseconds: number;
}
export interface Place {
  item: number; step: number; arm: number; outcome: number; time: number; error: number;
  turn: number;
}

/** Schedule.simulate makes one. */
export class Simulation extends Handle {
  private constructor();
  info(): SimulationInfo;
  places(): Place[];
}

export interface GeneratorOptions {
  preset?: 'text' | 'table'; kind?: number; w?: number; h?: number; mean?: number;
  sigma?: number; seed?: number | bigint;
}

export class Generator extends Handle {
  constructor(options?: GeneratorOptions);
  /** PKC_GENERATE_RANDOM: so many items. PKC_GENERATE_FULL: the next set, of at most so many. */
  next(most: number): Required<Item>[];
}

export interface GridFields {
  bin_w?: number; bin_h?: number; margin?: number; cell?: number; clearance?: number;
}

/** From the millimetres of a real bin to cells and back; what is not given is the paper's. A side
 * has floor((side - 2 * margin) / cell) cells, an item takes ceil((side + clearance) / cell). */
export class Grid {
  constructor(fields?: GridFields | null);
  /** Cells of the bin's sides. */
  bin(): { w: number; h: number };
  /** Cells that an item of w x h millimetres takes. */
  item(w: number, h: number): { w: number; h: number };
  /** Centre of a w x h rectangle of cells at cell (x, y), in millimetres from the inside top-left
   * corner of the bin. */
  centre(x: number, y: number, w: number, h: number): { x: number; y: number };
}

/** Of the linked library: "0.1.0". */
export function version(): string;

export const PKC_VERSION_MAJOR: number;
export const PKC_VERSION_MINOR: number;
export const PKC_VERSION_PATCH: number;
export const PKC_OK: number;
export const PKC_E_ARGUMENT: number;
export const PKC_E_STRUCT: number;
export const PKC_E_MEMORY: number;
export const PKC_E_BUSY: number;
export const PKC_E_STATE: number;
export const PKC_E_CAPACITY: number;
export const PKC_E_LIMIT: number;
export const PKC_E_FORMAT: number;
export const PKC_E_IO: number;
export const PKC_E_UNSUPPORTED: number;
export const PKC_E_INTERNAL: number;
export const PKC_ITEM_NO_ROTATE: number;
export const PKC_ITEM_PINNED: number;
export const PKC_OP_UNPACK: number;
export const PKC_OP_PACK: number;
export const PKC_OP_SKIP: number;
export const PKC_OP_TERMINATE: number;
export const PKC_MAX_ACTIONS: number;
export const PKC_MAX_SIDE: number;
export const PKC_CELL_FREE: number;
export const PKC_CELL_FIXED: number;
export const PKC_ARCH_HEURISTIC: number;
export const PKC_ARCH_ACTOR_CRITIC: number;
export const PKC_ARCH_FULLY_CONVOLUTIONAL: number;
export const PKC_ARCH_AFTERSTATE: number;
export const PKC_MAX_BLOB_BYTES: number;
export const PKC_LEARNER_A3C: number;
export const PKC_LEARNER_AFTERSTATE: number;
export const PKC_ROTATION_OFF: number;
export const PKC_ROTATION_ON: number;
export const PKC_ROTATION_MIXED: number;
export const PKC_METHOD_PAPER: number;
export const PKC_METHOD_EXACT: number;
export const PKC_REPACK_OFF: number;
export const PKC_REPACK_ANYTIME: number;
export const PKC_REPACK_FULL: number;
export const PKC_SELECT_AUTO: number;
export const PKC_SELECT_ALL: number;
export const PKC_UNLIMITED: number;
export const PKC_PROOF_NONE: number;
export const PKC_PROOF_OPTIMAL: number;
export const PKC_PROOF_IMPOSSIBLE: number;
export const PKC_PROOF_BUDGET: number;
export const PKC_PACKING_FOUND: number;
export const PKC_PACKING_IMPOSSIBLE: number;
export const PKC_PACKING_BUDGET: number;
export const PKC_MAX_JOINTS: number;
export const PKC_MAX_CELL_BYTES: number;
export const PKC_MODE_SYNC_PAPER: number;
export const PKC_MODE_ZONE_MUTEX: number;
export const PKC_MODE_COORDINATED: number;
export const PKC_WAIT_BELT: number;
export const PKC_WAIT_PLANNING: number;
export const PKC_WAIT_OTHER_ARM: number;
export const PKC_WAIT_BIN: number;
export const PKC_WAIT_CELLS: number;
export const PKC_WAIT_SYNC: number;
export const PKC_WAIT_DONE: number;
export const PKC_WAIT_COUNT: number;
export const PKC_ACTIVITY_TRAVEL: number;
export const PKC_ACTIVITY_LOWER: number;
export const PKC_ACTIVITY_GRIP: number;
export const PKC_ACTIVITY_RELEASE: number;
export const PKC_ACTIVITY_LIFT: number;
export const PKC_ACTIVITY_WAIT: number;
export const PKC_PLACE_OK: number;
export const PKC_PLACE_JAMMED: number;
export const PKC_PLACE_MISPLACED: number;
export const PKC_PLACE_ABSENT: number;
export const PKC_TRACE_CHROME: number;
export const PKC_TRACE_TIMELINE: number;
export const PKC_TRACE_JOINTS_0: number;
export const PKC_TRACE_JOINTS_1: number;
export const PKC_TRACE_GANTT: number;
export const PKC_TRACE_REPLAY: number;
export const PKC_GENERATE_RANDOM: number;
export const PKC_GENERATE_FULL: number;
