// SPDX-License-Identifier: Apache-2.0
// A flap of half the channel's width in three dimensions, its middle plane z = 0 one of symmetry: hexahedra, the section of fluid.geo
// drawn out from the flap's end (z = width / 2) to both sides; behind that end lies a gap as wide as half the flap.
DefineConstant [
  n_side = 10,        // cells along each side of the flap
  n_tip = 2,          // cells across its tip
  n_width = 3,        // cells across half its width, and across the gap
  growth = 1.3,       // of neighbouring cells, away from the flap
  wall_cells = 4      // in the part that narrows towards the upper wall
];

left = -3; right = 3; top = 4; mid = 2.8;  // m
half = 0.05; height = 1; width = 1;        // m; the flap

h = height / n_side;
n_left = Round(Log(1 + (-half - left) * (growth - 1) / h) / Log(growth));
n_right = Round(Log(1 + (right - half) * (growth - 1) / h) / Log(growth));
n_up = Round(Log(1 + (mid - height) * (growth - 1) / h) / Log(growth));

x() = {left, -half, half, right};
y() = {0, height, mid, top};
For j In {0 : 3}
  For i In {0 : 3}
    Point(4 * j + i + 1) = {x(i), y(j), width / 2};
  EndFor
EndFor

// Horizontal lines 10 + 3 * row + part, vertical lines 30 + 4 * part + column, sections 50 + 3 * row + part.
For j In {0 : 3}
  For i In {0 : 2}
    Line(10 + 3 * j + i) = {4 * j + i + 1, 4 * j + i + 2};
  EndFor
  Transfinite Curve {10 + 3 * j} = n_left + 1 Using Progression 1 / growth;
  Transfinite Curve {10 + 3 * j + 1} = n_tip + 1;
  Transfinite Curve {10 + 3 * j + 2} = n_right + 1 Using Progression growth;
EndFor
For j In {0 : 2}
  For i In {0 : 3}
    Line(30 + 4 * j + i) = {4 * j + i + 1, 4 * (j + 1) + i + 1};
  EndFor
EndFor
Transfinite Curve {30 : 33} = n_side + 1;
Transfinite Curve {34 : 37} = n_up + 1 Using Progression growth;
Transfinite Curve {38 : 41} = wall_cells + 1;

For j In {0 : 2}
  For i In {0 : 2}
    s = 50 + 3 * j + i;
    Curve Loop(s) = {10 + 3 * j + i, 30 + 4 * j + i + 1, -(10 + 3 * (j + 1) + i), -(30 + 4 * j + i)};
    Plane Surface(s) = {s};
    Transfinite Surface {s};
    Recombine Surface {s};
  EndFor
EndFor

// Of each block: [0] its far side, [1] the block, [2] below, [3] right, [4] above, [5] left.
inlet() = {}; outlet() = {}; walls() = {}; sides() = {}; flap() = {51}; blocks() = {};
For way In {0 : 1}
  For j In {0 : 2}
    For i In {0 : 2}
      If (way == 1 || 3 * j + i != 1)
        e() = Extrude {0, 0, (way == 0 ? -1 : 1) * width / 2} { Surface{50 + 3 * j + i}; Layers{n_width}; Recombine; };
        blocks() += e(1);
        sides() += e(0);
        If (i == 0)
          inlet() += e(5);
        EndIf
        If (i == 2)
          outlet() += e(3);
        EndIf
        If (j == 0)
          walls() += e(2);
        EndIf
        If (j == 2)
          walls() += e(4);
        EndIf
        If (way == 0 && j == 0)
          flap() += e(i == 0 ? 3 : 5);
        EndIf
        If (way == 0 && j == 1 && i == 1)
          flap() += e(2);
        EndIf
      EndIf
    EndFor
  EndFor
EndFor

Physical Surface("inlet") = inlet();
Physical Surface("outlet") = outlet();
Physical Surface("walls") = walls();
Physical Surface("sides") = sides();
Physical Surface("flap") = flap();
Physical Volume("fluid") = blocks();
