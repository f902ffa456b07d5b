// SPDX-License-Identifier: Apache-2.0
// Channel around two flaps on its floor, quadrilaterals only. The cells of flap.geo along a flap halve these.
DefineConstant [
  n_side = 40,        // cells along each side of a flap
  n_tip = 4,          // cells across its tip
  n_gap = 40,         // between the flaps
  growth = 1.15       // of neighbouring cells, away from the flaps
];

left = -3; right = 4; top = 4; half = 0.05; height = 1; apart = 1; // m
h = height / n_side;
n_left = Round(Log(1 + (-half - left) * (growth - 1) / h) / Log(growth));
n_right = Round(Log(1 + (right - apart - half) * (growth - 1) / h) / Log(growth));
n_up = Round(Log(1 + (top - height) * (growth - 1) / h) / Log(growth));

// Points 6 * row + column: rows at the bottom, the tips and the top.
x() = {left, -half, half, apart - half, apart + half, right};
y() = {0, height, top};
For j In {0 : 2}
  For i In {0 : 5}
    Point(6 * j + i + 1) = {x(i), y(j), 0};
  EndFor
EndFor
// Horizontal lines 10 + 5 * row + part; there are none inside the flaps' roots.
For j In {0 : 2}
  For i In {0 : 4}
    If (!(j == 0 && (i == 1 || i == 3)))
      Line(10 + 5 * j + i) = {6 * j + i + 1, 6 * j + i + 2};
    EndIf
  EndFor
  Transfinite Curve {10 + 5 * j} = n_left + 1 Using Progression 1 / growth;
  If (j > 0)
    Transfinite Curve {11 + 5 * j, 13 + 5 * j} = n_tip + 1;
  EndIf
  Transfinite Curve {12 + 5 * j} = n_gap + 1 Using Bump 0.5;
  Transfinite Curve {14 + 5 * j} = n_right + 1 Using Progression growth;
EndFor
// Vertical lines 30 + 6 * part + column.
For j In {0 : 1}
  For i In {0 : 5}
    Line(30 + 6 * j + i) = {6 * j + i + 1, 6 * (j + 1) + i + 1};
  EndFor
EndFor
Transfinite Curve {30 : 35} = n_side + 1;
Transfinite Curve {36 : 41} = n_up + 1 Using Progression growth;
For j In {0 : 1}
  For i In {0 : 4}
    If (!(j == 0 && (i == 1 || i == 3)))
      s = 50 + 5 * j + i;
      Curve Loop(s) = {10 + 5 * j + i, 30 + 6 * j + i + 1, -(10 + 5 * (j + 1) + i), -(30 + 6 * j + i)};
      Plane Surface(s) = {s};
      Transfinite Surface {s};
      Recombine Surface {s};
    EndIf
  EndFor
EndFor
Physical Curve("inlet") = {30, 36};
Physical Curve("outlet") = {35, 41};
Physical Curve("walls") = {10, 12, 14, 20 : 24};
Physical Curve("flaps") = {31, 16, 32, 33, 18, 34};
Physical Surface("fluid") = {50, 52, 54 : 59};
