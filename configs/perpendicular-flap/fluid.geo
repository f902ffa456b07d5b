// SPDX-License-Identifier: Apache-2.0
// Channel around the flap, quadrilaterals only. Those of solid.geo along the flap halve these.
DefineConstant [
  n_side = 80,        // cells along each side of the flap
  n_tip = 8,          // cells across its tip
  growth = 1.12,      // of neighbouring cells, away from the flap
  wall_growth = 1.12, // towards the upper wall
  wall_cells = 10    // in the part that narrows towards the upper wall
];

left = -3; right = 3; top = 4; mid = 2.8; // m; below mid the rows widen, above it they narrow
half = 0.05; height = 1;                  // m; the flap

h = height / n_side;
n_left = Round(Log(1 + (-half - left) * (growth - 1) / h) / Log(growth));
n_right = Round(Log(1 + (right - half) * (growth - 1) / h) / Log(growth));
n_up = Round(Log(1 + (mid - height) * (growth - 1) / h) / Log(growth));

// Points 4 * row + column: rows at the bottom, the tip, mid and the top.
x() = {left, -half, half, right};
y() = {0, height, mid, top};
For j In {0 : 3}
  For i In {0 : 3}
    Point(4 * j + i + 1) = {x(i), y(j), 0};
  EndFor
EndFor

// Horizontal lines 10 + 3 * row + part; there is none inside the flap's root.
For j In {0 : 3}
  For i In {0 : 2}
    If (!(j == 0 && i == 1))
      Line(10 + 3 * j + i) = {4 * j + i + 1, 4 * j + i + 2};
    EndIf
  EndFor
  Transfinite Curve {10 + 3 * j} = n_left + 1 Using Progression 1 / growth;
  If (j > 0)
    Transfinite Curve {10 + 3 * j + 1} = n_tip + 1;
  EndIf
  Transfinite Curve {10 + 3 * j + 2} = n_right + 1 Using Progression growth;
EndFor

// Vertical lines 30 + 4 * part + column.
For j In {0 : 2}
  For i In {0 : 3}
    Line(30 + 4 * j + i) = {4 * j + i + 1, 4 * (j + 1) + i + 1};
  EndFor
EndFor
Transfinite Curve {30 : 33} = n_side + 1;
Transfinite Curve {34 : 37} = n_up + 1 Using Progression growth;
Transfinite Curve {38 : 41} = wall_cells + 1 Using Progression 1 / wall_growth;

For j In {0 : 2}
  For i In {0 : 2}
    If (!(j == 0 && i == 1))
      s = 50 + 3 * j + i;
      Curve Loop(s) = {10 + 3 * j + i, 30 + 4 * j + i + 1, -(10 + 3 * (j + 1) + i), -(30 + 4 * j + i)};
      Plane Surface(s) = {s};
      Transfinite Surface {s};
      Recombine Surface {s};
    EndIf
  EndFor
EndFor

Physical Curve("inlet") = {30, 34, 38};
Physical Curve("outlet") = {33, 37, 41};
Physical Curve("walls") = {10, 12, 19, 20, 21};
Physical Curve("flap") = {31, 14, 32}; // left side, tip, right side
Physical Surface("fluid") = {50, 52 : 58};
