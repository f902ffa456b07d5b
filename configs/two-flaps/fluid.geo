// SPDX-License-Identifier: Apache-2.0
// Channel around a row of flaps on its floor, quadrilaterals only. The cells of flap.geo along a flap halve these.
DefineConstant [
  flaps = 2,          // their number
  n_side = 40,        // cells along each side of a flap
  n_tip = 4,          // cells across its tip
  n_gap = 40,         // between the flaps
  growth = 1.15       // of neighbouring cells, away from the flaps
];

left = -3; top = 4; half = 0.05; height = 1; apart = 1; // m
last = (flaps - 1) * apart; right = last + 3;
columns = 2 * flaps + 2; parts = columns - 1; // a flap stands on each odd part
h = height / n_side;
n_left = Round(Log(1 + (-half - left) * (growth - 1) / h) / Log(growth));
n_right = Round(Log(1 + (right - last - half) * (growth - 1) / h) / Log(growth));
n_up = Round(Log(1 + (top - height) * (growth - 1) / h) / Log(growth));

// Points columns * row + column + 1: rows at the bottom, the tips and the top.
x() = {left};
For k In {0 : flaps - 1}
  x() += {k * apart - half, k * apart + half};
EndFor
x() += {right};
y() = {0, height, top};
For j In {0 : 2}
  For i In {0 : parts}
    Point(columns * j + i + 1) = {x(i), y(j), 0};
  EndFor
EndFor
// Horizontal lines 100 + parts * row + part; there are none inside the flaps' roots.
For j In {0 : 2}
  For i In {0 : parts - 1}
    If (!(j == 0 && i % 2 == 1))
      line = 100 + parts * j + i;
      Line(line) = {columns * j + i + 1, columns * j + i + 2};
      If (i == 0)
        Transfinite Curve {line} = n_left + 1 Using Progression 1 / growth;
      ElseIf (i == parts - 1)
        Transfinite Curve {line} = n_right + 1 Using Progression growth;
      ElseIf (i % 2 == 1)
        Transfinite Curve {line} = n_tip + 1;
      Else
        Transfinite Curve {line} = n_gap + 1 Using Bump 0.5;
      EndIf
    EndIf
  EndFor
EndFor
// Vertical lines 200 + columns * part + column.
For j In {0 : 1}
  For i In {0 : parts}
    Line(200 + columns * j + i) = {columns * j + i + 1, columns * (j + 1) + i + 1};
    If (j == 0)
      Transfinite Curve {200 + i} = n_side + 1;
    Else
      Transfinite Curve {200 + columns + i} = n_up + 1 Using Progression growth;
    EndIf
  EndFor
EndFor
surfaces() = {}; floor() = {}; ceiling() = {}; wet() = {};
For j In {0 : 1}
  For i In {0 : parts - 1}
    below = 100 + parts * j + i; above = below + parts; beside = 200 + columns * j + i;
    If (!(j == 0 && i % 2 == 1))
      s = 300 + parts * j + i;
      Curve Loop(s) = {below, beside + 1, -above, -beside};
      Plane Surface(s) = {s};
      Transfinite Surface {s};
      Recombine Surface {s};
      surfaces() += {s};
      If (j == 0)
        floor() += {below};
      Else
        ceiling() += {above};
      EndIf
    Else
      wet() += {beside, above, beside + 1};
    EndIf
  EndFor
EndFor
Physical Curve("inlet") = {200, 200 + columns};
Physical Curve("outlet") = {200 + parts, 200 + columns + parts};
Physical Curve("walls") = {floor(), ceiling()};
Physical Curve("flaps") = {wet()};
Physical Surface("fluid") = {surfaces()};
