// SPDX-License-Identifier: Apache-2.0
// Channel 2.5 x 0.41 m, cylinder of diameter 0.1 m at (0.2, 0.2) with a plate 0.02 m thick behind it up to x = 0.6 m:
// blocks of quadrilaterals, rings around the cylinder, rows along the plate.
// What counts are the layers that leave the cylinder and the plate: many cells across them, few along them.
DefineConstant[ n = 36 ];
n_arc = Round(0.8 * n);            // on a quarter of the cylinder
n_ring = Round(1.5 * n);           // from the cylinder to the square
n_plate = Round(1.6 * n);          // along the plate behind the square
n_wake = Round(2.4 * n);
n_left = Round(0.45 * n);
n_side = Round(0.5 * n);
n_tip = Round(0.5 * n);
n_half = Round(1.8 * n);           // from the plate to the upper (lower) end of the square
g = 5 ^ (1 / n_ring);

r = 0.05; c = 0.2; s = 0.085; q = r / Sqrt(2); h = 0.01;
f = Sqrt(r ^ 2 - h ^ 2);
x() = {0, c - s, c + s, 0.6, 2.5};
y() = {0, c - s, c - h, c + h, c + s, 0.41};
For j In {0 : 5}
  For i In {0 : 4}
    Point(10 * j + i + 1) = {x(i), y(j), 0};
  EndFor
EndFor
Point(101) = {c + f, c + h, 0};    // where the plate meets the cylinder, then counter-clockwise
Point(102) = {c + q, c + q, 0};
Point(103) = {c - q, c + q, 0};
Point(104) = {c - q, c - q, 0};
Point(105) = {c + q, c - q, 0};
Point(106) = {c + f, c - h, 0};
Point(107) = {c, c, 0};

// Rings.
For k In {0 : 4}
  Circle(200 + k) = {101 + k, 107, 102 + k};
EndFor
Transfinite Curve {200, 204} = n_half + 1 Using Progression 1;
Transfinite Curve {201 : 203} = n_arc + 1;
Line(210) = {101, 33}; Line(211) = {102, 43}; Line(212) = {103, 42};
Line(213) = {104, 12}; Line(214) = {105, 13}; Line(215) = {106, 23};
Transfinite Curve {210 : 215} = n_ring + 1 Using Progression g;

// Horizontal lines of the grid: 300 + 10 * row + column; vertical ones: 400 + 10 * row + column.
Macro Horizontal
  Line(300 + 10 * j + i) = {10 * j + i + 1, 10 * j + i + 2};
Return
Macro Vertical
  Line(400 + 10 * j + i) = {10 * j + i + 1, 10 * (j + 1) + i + 1};
Return
For j In {0 : 5}
  For i In {0 : 3}
    If (i >= 2 || j == 0 || j == 1 || j == 4 || j == 5)
      Call Horizontal;
    EndIf
  EndFor
EndFor
For j In {0 : 4}
  For i In {0 : 4}
    If (j == 0 || j == 4 || i >= 2)
      If (!(j == 2 && i == 2))
        Call Vertical;
      EndIf
    EndIf
  EndFor
EndFor
Line(450) = {11, 41}; Line(451) = {12, 42}; // left of the square the middle is one block
Transfinite Curve {450, 451} = n_arc + 1;
Transfinite Curve {300, 310, 340, 350} = n_left + 1 Using Progression 1 / 1.01;
Transfinite Curve {301, 311, 341, 351} = n_arc + 1;
Transfinite Curve {302, 312, 322, 332, 342, 352} = n_plate + 1 Using Bump 0.5;
Transfinite Curve {303, 313, 323, 333, 343, 353} = n_wake + 1 Using Progression 1.025 ^ (40 / n);
Transfinite Curve {400 : 404, 440 : 444} = n_side + 1 Using Bump 0.4;
Transfinite Curve {412 : 414} = n_half + 1 Using Progression 1 / 1.025 ^ (32 / n);
Transfinite Curve {423, 424} = n_tip + 1;
Transfinite Curve {432 : 434} = n_half + 1 Using Progression 1.025 ^ (32 / n);

Curve Loop(500) = {210, 432, -211, -200};
Curve Loop(501) = {211, -341, -212, -201};
Curve Loop(502) = {212, -451, -213, -202};
Curve Loop(503) = {213, 311, -214, -203};
Curve Loop(504) = {214, 412, -215, -204};
For k In {0 : 4}
  Plane Surface(500 + k) = {500 + k};
  Transfinite Surface {500 + k};
EndFor
For j In {0 : 4}
  For i In {0 : 3}
    If ((j == 0 || j == 4 || i >= 2) && !(j == 2 && i == 2))
      l = 600 + 10 * j + i;
      Curve Loop(l) = {300 + 10 * j + i, 400 + 10 * j + i + 1, -(300 + 10 * (j + 1) + i), -(400 + 10 * j + i)};
      Plane Surface(l) = {l};
      Transfinite Surface {l};
    EndIf
  EndFor
EndFor
Curve Loop(700) = {310, 451, -340, -450};
Plane Surface(700) = {700};
Transfinite Surface {700};
surfaces() = Surface "*";
Recombine Surface {surfaces()};
Physical Curve("inlet") = {400, 440, 450};
Physical Curve("outlet") = {404, 414, 424, 434, 444};
Physical Curve("walls") = {300 : 303, 350 : 353};
Physical Curve("cylinder") = {200 : 204};
Physical Curve("plate") = {210, 215, 322, 332, 423};
Physical Surface("fluid") = {surfaces()};
