# SPDX-License-Identifier: Apache-2.0
"""Rules for driving each core, and the cycles in which its outputs count: the assumptions of equivalence.py.

They allow at least what the testbenches do, and no more than the headers of hdl/ promise to work.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from commands.verify.equivalence import Protocol

# `live` is high after the first reset.
LIVE = "  reg live = 1'b0;\n  always @(posedge clk) live <= live | rst;\n"


def settled(clocks: int) -> str:
    """`settled`: so many clocks with en have passed."""
    return f"""
  reg [7:0] passed = 8'd0;
  wire settled = passed == 8'd{clocks};
  always @(posedge clk) if (en & ~settled) passed <= passed + 8'd1;
"""


def axis_source(prefix: str, *fields: str) -> tuple[str, tuple[str, ...]]:
    """Registers and assumptions: what is offered stays until it is taken; nothing in reset and in the clock after."""
    payload = "{" + ", ".join(prefix + name for name in fields) + "}"
    registers = (
        "  reg was_reset = 1'b1, waits = 1'b0;\n  reg [63:0] held_word;\n"
        f"  always @(posedge clk) begin\n    was_reset <= rst;\n    waits <= {prefix}valid & ~{prefix}ready & ~rst;\n"
        f"    held_word <= {payload};\n  end\n"
    )
    return registers, (
        f"~{prefix}valid | ~(rst | was_reset)",
        f"~waits | rst | ({prefix}valid & held_word == {payload})",
    )


def round_saturate(_: Mapping[str, int]) -> Protocol:
    return Protocol()


def multiply(_: Mapping[str, int]) -> Protocol:
    return Protocol(settled(1), (), {"product": "settled"})


def dot_product(_: Mapping[str, int]) -> Protocol:
    return Protocol(settled(4), (), {"sum": "settled"})


def rom(parameters: Mapping[str, int]) -> Protocol:
    return Protocol(settled(1), (f"address < {parameters['Depth']}",), {"data": "settled"})


def thomas_table(parameters: Mapping[str, int]) -> Protocol:
    within = f"row < {parameters['Rows']}"
    return Protocol(settled(5), (within,), {"coefficient": "settled", "shift": "settled"})


def burst_counter(_: Mapping[str, int]) -> Protocol:
    return Protocol(LIVE, (), {"position": "live & active", "active": "live"})


def delay_line(parameters: Mapping[str, int]) -> Protocol:
    delay = parameters["Delay"]
    filled = f"""
  reg [7:0] words = 8'd0;
  always @(posedge clk) words <= rst ? 8'd0 : words + (en & live & words != 8'd{delay});
"""
    return Protocol(LIVE + filled, (), {"out": f"words == 8'd{delay} & ~rst"})


def ram(parameters: Mapping[str, int]) -> Protocol:
    """Never a read of the word that is being written; addresses within the memory."""
    depth = parameters["Depth"]
    return Protocol(
        "",
        (
            "~(read_en & write_en & read_address == write_address)",
            f"~read_en | read_address < {depth}",
            f"~write_en | write_address < {depth}",
        ),
    )


def axis_skid(_: Mapping[str, int]) -> Protocol:
    registers, assume = axis_source("s_", "data")
    return Protocol(LIVE + registers, assume, {"s_ready": "live", "m_valid": "live", "m_data": "live & m_valid"})


def frame_guard(_: Mapping[str, int]) -> Protocol:
    registers, assume = axis_source("s_", "data", "last", "user")
    pixel, clock = "live & ~rst & en & out_valid", "live & ~rst"
    data = ("data", "first_row", "first_column", "last_row", "last_column")
    compare = {f"out_{name}": pixel for name in data}
    compare |= {f"out_{name}": f"{clock} & en" for name in ("valid", "frame_start", "frame_end")}
    compare |= dict.fromkeys(("s_ready", "row_short", "row_long", "start_missing", "start_early", "timed_out"), clock)
    return Protocol(LIVE + registers, assume, compare | {"out_bad": f"{pixel} & out_frame_end"})


def threshold_comparator(_: Mapping[str, int]) -> Protocol:
    """The first beat after a reset is the first of a frame."""
    begun = "  reg begun = 1'b0;\n  always @(posedge clk) begun <= ~rst & (begun | in_valid & in_user);\n"
    return Protocol(LIVE + begun, ("~in_valid | rst | begun | in_user",), {"contact": "live & ~rst"})


def contact_events(parameters: Mapping[str, int]) -> Protocol:
    """Rows of Columns depths, Rows of them a frame; one may begin inside another, none but the first after a reset may
    lack its start. Last depths lie at least a frame apart, which is all that is asked of them."""
    rows, columns = parameters["Rows"], parameters["Columns"]
    registers = """
  reg [15:0] place = 16'd0;  // of the next depth; 0: of a frame's first
  reg [15:0] column = 16'd0;
  always @(posedge clk) begin
    if (rst) place <= 16'd0;
    else if (in_valid) begin
      place <= in_frame_end ? 16'd0 : (in_user ? 16'd0 : place) + 16'd1;
      column <= in_last ? 16'd0 : (in_user ? 16'd0 : column) + 16'd1;
    end
  end
"""
    marks = (
        "(in_user | place != 16'd0)"
        f" & in_last == ((in_user ? 16'd0 : column) == 16'd{columns - 1})"
        f" & in_frame_end == ((in_user ? 16'd0 : place) == 16'd{rows * columns - 1})"
    )
    clock = "live & ~rst"
    compare = dict.fromkeys(("touching", "record_valid", "record", "event_lost", "m_event_tvalid"), clock)
    compare |= dict.fromkeys(("m_event_tdata", "m_event_tlast"), f"{clock} & m_event_tvalid")
    return Protocol(LIVE + registers, (f"~in_valid | rst | ({marks})",), compare)


def depth_gate(_: Mapping[str, int]) -> Protocol:
    """Frames of any number of words, in successive enabled clocks; what is present stays while en is low. After a reset
    the first word is a frame's first."""
    registers = """
  reg open = 1'b0, stays = 1'b0;
  reg [63:0] word_before;
  always @(posedge clk) begin
    if (rst) open <= 1'b0;
    else if (en & in_valid) open <= ~in_frame_end;
    stays <= in_valid & ~en & ~rst;
    word_before <= rst ? 0 : {in_user, in_last, in_frame_end, in_data};
  end
"""
    assume = (
        "rst | in_valid | ~open",
        "rst | ~in_valid | in_user == ~open",
        "rst | ~stays | (in_valid & word_before == {in_user, in_last, in_frame_end, in_data})",
    )
    clock = "live & ~rst"
    compare = dict.fromkeys(("en", "event_dropped", "m_valid", "look_valid"), clock)
    for name in ("user", "last", "frame_end", "data"):
        compare |= {f"m_{name}": f"{clock} & m_valid", f"look_{name}": f"{clock} & look_valid"}
    return Protocol(LIVE + registers, assume, compare)


def gradient_lookup(_: Mapping[str, int]) -> Protocol:
    """Nothing is written while a change-over is due, or with a read; an entry stands 2 clocks after it is asked for.
    Frames have more than one pixel."""
    registers = """
  reg asked = 1'b0, reads = 1'b0, begun = 1'b0;
  always @(posedge clk) begin
    if (en) begun <= in_valid & in_place[0] & in_place[1];
    asked <= ~rst & table_read;
    if (rst) reads <= 1'b0;
    else if (asked) reads <= 1'b1;
  end
"""
    assume = (
        "~table_write | ~rst & table_bank == table_in_use & ~table_read",
        "~table_read | ~rst",
        "~(begun & in_valid & in_place[0] & in_place[1])",
    )
    word, read = "live & ~rst & en & out_valid", "live & reads"
    compare = {"out_gx": word, "out_gy": word, "out_place": word, "out_valid": "live & ~rst & en"}
    compare |= {"table_read_gx": read, "table_read_gy": read, "table_in_use": "live"}
    return Protocol(LIVE + registers, assume, compare)


def quadratic_gradient(_: Mapping[str, int]) -> Protocol:
    """Frames of two rows or more, of four pixels or more, cut short by a reset alone; how long they are is left open.

    Nothing is written while a change-over is due, or in the clock of a read.
    """
    registers = """
  reg [1:0] column = 2'd0;  // pixels taken of this row, up to three
  reg begun = 1'b0, second_row = 1'b0, read = 1'b0;
  reg still = 1'b0, valid_before;
  reg [3:0] place_before;
  always @(posedge clk) begin
    still <= ~en & ~rst;
    valid_before <= rst ? 0 : in_valid;
    place_before <= rst ? 0 : in_place;
    read <= live & (read | table_read);
    if (rst) begin
      begun <= 1'b0;
      second_row <= 1'b0;
      column <= 2'd0;
    end else if (en & in_valid) begin
      begun <= 1'b1;
      column <= in_place[1] ? 2'd0 : column + (column != 2'd3);
      if (in_place[1]) second_row <= ~in_place[0];
    end
  end
"""
    marks = "begun ? ~in_place[1] | (column == 2'd3 & (~in_place[0] | second_row)) : &in_place[1:0]"
    assume = (
        f"~in_valid | rst | ({marks})",
        "~still | rst | (in_valid == valid_before & (~in_valid | in_place == place_before))",
        "~table_write | (live & ~rst & ~table_read & table_bank == table_in_use)",
        "table_index < 6'd36",
    )
    word = f"{MOVES} & out_valid"
    compare = {"out_gx": word, "out_gy": word, "out_place": word, "out_valid": MOVES, "table_in_use": "live"}
    compare |= {"saturations": "live & ~rst", "table_read_word": "read"}
    return Protocol(LIVE + registers, assume, compare)


def bursts(size: int, rows: int | None, out_size: int | None = None, word: str = "") -> Protocol:
    """Protocol of a core between bursts: `size` words in successive enabled clocks, the first with in_start.

    A frame begins with in_frame_start, at any burst, after less than a frame too; after a reset none has begun.
    `rows`: bursts in a frame, if they are counted. Inputs stay while en is low. `word`: the expression of more words
    in than those, where a core has no bursts going in.
    """
    out_size = out_size or size
    registers = f"""
  reg [15:0] in_left = 16'd0, out_left = 16'd0, rows_left = 16'd0;
  reg still = 1'b0, start_before, frame_start_before;
  always @(posedge clk) begin
    still <= ~en & ~rst;
    start_before <= rst ? 0 : in_start;
    frame_start_before <= rst ? 0 : in_frame_start;
    if (rst) begin
      in_left <= 16'd0;
      out_left <= 16'd0;
      rows_left <= 16'd0;
    end else if (en) begin
      in_left <= in_start ? 16'd{size - 1} : in_left - (in_left != 16'd0);
      out_left <= out_start ? 16'd{out_size - 1} : out_left - (out_left != 16'd0);
      if (in_frame_start) rows_left <= 16'd{(rows or 2) - 1};
      else if (in_start & {int(rows is not None)}) rows_left <= rows_left - 16'd1;
    end
  end
"""
    assume = (
        "~in_start | in_left == 16'd0",
        "~in_frame_start | in_start",
        "~in_start | rst | in_frame_start | rows_left != 16'd0",
        "~still | rst | (in_start == start_before & in_frame_start == frame_start_before)",
    )
    return Protocol(LIVE + registers, assume, OUT_OF_BURSTS)


MOVES = "live & ~rst & en"
IN_A_BURST = f"{MOVES} & (out_start | out_left != 16'd0)"
OUT_OF_BURSTS = {"out_start": MOVES, "out_frame_start": MOVES, "saturations": "live & ~rst"}
OUT_OF_BURSTS |= dict.fromkeys(("out_data", "out_re", "out_im", "out_mode", "out_mirrored"), IN_A_BURST)


def words(size: int, rows: int | None, whole: bool) -> Protocol:
    """Protocol of a core with single words going in and bursts of `size` going out.

    A frame begins with in_frame_start, at any word, or (`whole`) only after the one before is complete.
    """
    pixels = size * (rows or 2)
    registers = f"""
  reg [23:0] left = 24'd0;
  reg [15:0] out_left = 16'd0;
  reg begun = 1'b0, still = 1'b0, valid_before, frame_start_before;
  always @(posedge clk) begin
    still <= ~en & ~rst;
    valid_before <= rst ? 0 : in_valid;
    frame_start_before <= rst ? 0 : in_frame_start;
    if (rst) begin
      left <= 24'd0;
      out_left <= 16'd0;
      begun <= 1'b0;
    end else if (en) begin
      if (in_valid) begun <= 1'b1;
      if (in_valid) left <= in_frame_start ? 24'd{pixels - 1} : left - 24'd1;
      out_left <= out_start ? 16'd{size - 1} : out_left - (out_left != 16'd0);
    end
  end
"""
    assume = [
        "~in_frame_start | in_valid",
        "~in_valid | rst | in_frame_start | " + ("left != 24'd0" if rows is not None else "begun"),
        "~still | rst | (in_valid == valid_before & in_frame_start == frame_start_before)",
    ]
    if whole:
        assume.append("~in_frame_start | left == 24'd0")
    return Protocol(LIVE + registers, tuple(assume), OUT_OF_BURSTS)


def divergence(parameters: Mapping[str, int]) -> Protocol:
    """The marks are those of pixels in raster order; how many rows a frame has is left open."""
    columns = parameters["Columns"]
    registers = """
  reg [15:0] column = 16'd0;
  reg first = 1'b1, last_before, still = 1'b0, valid_before;
  always @(posedge clk) begin
    still <= ~en & ~rst;
    valid_before <= rst ? 0 : in_valid;
    if (rst) begin
      column <= 16'd0;
      first <= 1'b1;
    end else if (en & in_valid) begin
      column <= in_last_column ? 16'd0 : column + 16'd1;
      if (in_last_column) first <= in_last_row;
      last_before <= rst ? 0 : in_last_row;
    end
  end
"""
    marks = (
        f"in_first_column == (column == 16'd0) & in_last_column == (column == 16'd{columns - 1})"
        " & in_first_row == first & (column == 16'd0 | in_last_row == last_before)"
    )
    assume = (f"~in_valid | rst | ({marks})", "~still | rst | in_valid == valid_before")
    return Protocol(
        LIVE + registers,
        assume,
        {"out_valid": MOVES, "out_frame_start": MOVES, "out_data": f"{MOVES} & out_valid"},
    )


def marked(**marks: str) -> dict[str, str]:
    """With every word its marks, anything between them."""
    return {name: f"in_valid & ~rst ? {mark} : {name}" for name, mark in marks.items()}


def raster(parameters: Mapping[str, int]) -> tuple[str, dict[str, str]]:
    """Registers and what is given: places of pixels in raster order, whole frames but for a reset."""
    rows, columns = parameters["Rows"], parameters["Columns"]
    registers = f"""
  reg [15:0] in_row = 16'd0, in_column = 16'd0;
  wire [3:0] place = {{
    in_column == 16'd{columns - 1}, in_row == 16'd{rows - 1}, in_column == 16'd0, in_row == 16'd0
  }};
  always @(posedge clk) begin
    if (rst) begin
      in_row <= 16'd0;
      in_column <= 16'd0;
    end else if (en & in_valid) begin
      in_column <= place[3] ? 16'd0 : in_column + 16'd1;
      if (place[3]) in_row <= place[2] ? 16'd0 : in_row + 16'd1;
    end
  end
"""
    return registers, marked(in_place="place")


# Of the bus of gain_map.
SETTLED = "table_bank == table_in_use"
READ = "live & read & read_left == 2'd0"
READS = """
  reg [1:0] read_left = 2'd0;  // clocks until what was read stands
  reg read = 1'b0;
  always @(posedge clk) begin
    if (rst) begin
      read_left <= 2'd0;
      read <= 1'b0;
    end else begin
      read_left <= table_read ? 2'd2 : read_left - (read_left != 2'd0);
      read <= read | table_read;
    end
  end
"""


def gain_map(parameters: Mapping[str, int]) -> Protocol:
    """Bus and capture one at a time, neither while a change-over is due, but for what the bus reads."""
    registers, given = raster(parameters)
    nodes = (parameters["Rows"] >> parameters["BlockLog2"]) * (parameters["Columns"] >> parameters["BlockLog2"])
    registers += READS + "  reg captured = 1'b0;\n  always @(posedge clk) captured <= capture_read;\n"
    assume = (
        f"~(table_write | capture_write | capture_read) | ({SETTLED} & ~rst & ~table_read & read_left == 2'd0)",
        "~table_read | ~rst & read_left == 2'd0",
        "~table_write | ~capture_write & ~capture_read",
        "~capture_write | ~capture_read | capture_write_node != capture_read_node",
        f"(table_index >> 2) < {nodes} & capture_write_node < {nodes} & capture_read_node < {nodes}",
    )
    word = f"{MOVES} & out_valid"
    compare = {
        "out_valid": MOVES,
        "out_place": word,
        "out_gains": word,
        "table_in_use": "live",
        "table_read_gain": READ,
        "capture_read_gains": "captured",
    }
    return Protocol(LIVE + registers, assume, compare, given)


def flat_field(parameters: Mapping[str, int]) -> Protocol:
    inside = gain_map(parameters)
    compare = dict(inside.compare)
    del compare["out_gains"]
    compare |= {f"out_{colour}": compare["out_place"] for colour in ("red", "green", "blue")}
    compare |= dict.fromkeys(("dark", "saturations"), "live & ~rst")
    return replace(inside, compare=compare)


def reference_capture(parameters: Mapping[str, int]) -> Protocol:
    """Whatever the memory answers."""
    registers, given = raster(parameters)
    compare = dict.fromkeys(("busy", "done", "map_read", "map_write"), "live & ~rst")
    compare |= dict.fromkeys(("map_write_node", "map_write_gains"), "live & ~rst & map_write")
    compare |= {"map_read_node": "live & ~rst & map_read"}
    return Protocol(LIVE + registers, (), compare, given)


def depth_frames(parameters: Mapping[str, int]) -> tuple[str, dict[str, str]]:
    """Registers and what is given: marks of depth in raster order, whole frames but for a reset."""
    registers, _ = raster(parameters)
    return registers, marked(in_last="place[3]", in_frame_end="place[3] & place[2]", in_user="place[1] & place[0]")


def auto_zero(parameters: Mapping[str, int]) -> Protocol:
    """Bus and capture one at a time, neither while a change-over is due, but for what the bus reads."""
    registers, given = depth_frames(parameters)
    nodes = (parameters["Rows"] >> parameters["BlockLog2"]) * (parameters["Columns"] >> parameters["BlockLog2"])
    registers += READS
    assume = (
        f"~(table_write | capture_write) | ({SETTLED} & ~rst & ~table_read & read_left == 2'd0)",
        "~table_read | ~rst & read_left == 2'd0",
        "~table_write | ~capture_write",
        f"table_index < {nodes} & capture_write_node < {nodes}",
    )
    compare = {f"out_{name}": f"{MOVES} & out_valid" for name in ("user", "last", "frame_end", "data")}
    compare |= {"out_valid": MOVES, **dict.fromkeys(("active", "saturation"), "live & ~rst")}
    return Protocol(LIVE + registers, assume, compare | {"table_in_use": "live", "table_read_floor": READ}, given)


def floor_capture(parameters: Mapping[str, int]) -> Protocol:
    registers, given = depth_frames(parameters)
    compare = {"busy": "live & ~rst", "done": "live & ~rst", "map_write": "live"}
    compare |= dict.fromkeys(("map_write_node", "map_write_floor"), "live & map_write")
    return Protocol(LIVE + registers, (), compare, given)


def frame_output(_: Mapping[str, int]) -> Protocol:
    """Anything may come; in_bad and in_data count where a model looks at them. Unlike the testbench: in reset too."""
    word = f"{MOVES} & out_valid"
    compare = dict.fromkeys(("out_data", "out_last", "out_user"), word)
    return Protocol(LIVE, (), compare | dict.fromkeys(("active", "frame_end", "out_of_step", "out_valid"), MOVES))


def frame_tags(parameters: Mapping[str, int]) -> Protocol:
    """Frames end at least Pixels enabled clocks apart. A push stays while en is low."""
    pixels = parameters["Pixels"]
    registers = f"""
  reg [15:0] since = 16'd0;  // 0: none yet after the reset
  reg still = 1'b0, push_before;
  always @(posedge clk) begin
    still <= ~en & ~rst;
    push_before <= rst ? 0 : push;
    if (rst) since <= 16'd0;
    else if (en) since <= push ? 16'd1 : since + (since != 16'd0 & since != 16'd{pixels});
  end
"""
    assume = (
        f"~push | rst | since == 16'd0 | since == 16'd{pixels}",
        "~still | rst | push == push_before",
    )
    return Protocol(LIVE + registers, assume, dict.fromkeys(("due", "due_tag", "held"), "live"))


def axil_client() -> tuple[str, tuple[str, ...], dict[str, str]]:
    """Registers, assumptions, outputs of an AXI4-Lite port: what is offered stays until it is taken."""
    parts, assume = [], []
    for channel, fields in (("aw", ("addr",)), ("w", ("data", "strb")), ("ar", ("addr",))):
        prefix = f"s_axil_{channel}"
        payload = "{" + ", ".join(prefix + name for name in fields) + "}"
        parts.append(
            f"  reg {channel}_waits = 1'b0;\n  reg [63:0] {channel}_word;\n  always @(posedge clk) begin\n"
            f"    {channel}_waits <= {prefix}valid & ~{prefix}ready & ~rst;\n    {channel}_word <= {payload};\n  end\n"
        )
        assume.append(f"~{channel}_waits | rst | ({prefix}valid & {channel}_word == {payload})")
    compare = {"s_axil_bresp": "live & s_axil_bvalid"}
    compare |= dict.fromkeys(("s_axil_rdata", "s_axil_rresp"), "live & s_axil_rvalid")
    compare |= {f"s_axil_{pin}": "live" for pin in ("awready", "wready", "bvalid", "arready", "rvalid")}
    return "".join(parts), tuple(assume), compare


def axil_registers(_: Mapping[str, int]) -> Protocol:
    registers, assume, compare = axil_client()
    held = (
        *("threshold", "timeout", "hold_contact", "table_select", "table_index", "table_high", "table_bank"),
        *("off_threshold", "minimum_area", "debounce", "drop_frames", "dark_level", "capture_log2_frames"),
        "floor_log2_frames",
    )
    compare |= dict.fromkeys((*held, "table_write", "table_read", "capture_request", "floor_request"), "live")
    return Protocol(LIVE + registers, assume, compare | {"table_low": "live & table_write"})


def tactile_depth(_: Mapping[str, int]) -> Protocol:
    registers, assume, compare = axil_client()
    source, offered = axis_source("s_axis_t", "data", "last", "user")
    compare |= dict.fromkeys((f"m_axis_t{name}" for name in ("data", "last", "user")), "live & m_axis_tvalid")
    compare |= {"s_axis_tready": "live", "m_axis_tvalid": "live", "contact": "live & ~rst"}
    compare |= {"m_event_tvalid": "live & ~rst"}
    compare |= dict.fromkeys(("m_event_tdata", "m_event_tlast"), "live & ~rst & m_event_tvalid")
    return Protocol(LIVE + registers + source, (*assume, *offered), compare)
