// SPDX-License-Identifier: Apache-2.0
// td_tables_pkg: in simulation alone, whether the files of the tables are those that were written.
//
// tables.crc names the files of a configuration, a line each: CRC-32, name; models/tactile_depth/chip/rom_files.py writes
// it with them. Characters of carriage return do not count, so that files may pass through other systems.

`default_nettype none

package td_tables_pkg;

`ifndef SYNTHESIS
  // synthesis translate_off

  // Return what is wrong with a file that is to be read, "" if it is there.
  function automatic string missing(input string path);
    int file;
    file = $fopen(path, "r");
    if (file == 0) begin
      return {path, ": no such file: copy all that was written with the tables to TableFolder, which is seen from the ",
              "folder in which the simulation runs"};
    end
    $fclose(file);
    return "";
  endfunction

  // Return the CRC-32 of a file.
  function automatic logic [31:0] crc_of(input string path);
    int file;
    logic signed [31:0] character;
    logic [31:0] crc, steps[256];
    for (int n = 0; n < 256; n++) begin
      crc = n;
      for (int b = 0; b < 8; b++) crc = crc >> 1 ^ (crc[0] ? td_link_pkg::CrcPolynomial : 32'd0);
      steps[n] = crc;
    end
    crc = '1;
    file = $fopen(path, "r");
    character = $fgetc(file);
    while (character >= 0) begin
      if (character != 13) crc = crc >> 8 ^ steps[crc[7:0]^character[7:0]];
      character = $fgetc(file);
    end
    $fclose(file);
    return ~crc;
  endfunction

  // Return what is wrong with the tables in a folder, "" if they are as written and, unless 0, those of TablesCrc.
  function automatic string fault(input string folder, input int tables_crc);
    int list;
    logic [31:0] crc;
    logic [8*64-1:0] name;
    string path, found;
    path = {folder, "tables.crc"};
    found = missing(path);
    if (found != "") return found;
    if (tables_crc != 0 && crc_of(path) != tables_crc) begin
      return {path, ": the tables are not those of Config: write both with one command"};
    end
    list = $fopen(path, "r");
    while (found == "" && $fscanf(list, "%h %s", crc, name) == 2) begin
      path = $sformatf("%0s%0s", folder, name);
      found = missing(path);
      if (found == "" && crc_of(path) != crc) found = {path, ": changed since it was written: write the tables anew"};
    end
    $fclose(list);
    return found;
  endfunction

  // synthesis translate_on
`endif

endpackage

`default_nettype wire
