// SPDX-License-Identifier: Apache-2.0
// A rubber dome on the floor of a channel, full of fluid that is pumped through its foot: one file for three meshes.
DefineConstant [
  part = 0, // 0: fluid in the dome, 1: dome, 2: fluid in the channel
  n = 24,   // faces along the dome, even
  m = 4     // cells over its thickness
];
a = 0.1; r = 0.3; t = 0.03; // m: radius of the pump, inner radius and thickness of the dome
R = r + t;
Point(1) = {0, 0, 0};
If (part == 2)
  left = -1.2; right = 2; top = 1.2; h = Pi * R / n;
  Point(2) = {R, 0, 0, h}; Point(3) = {0, R, 0, h}; Point(4) = {-R, 0, 0, h};
  Point(5) = {left, 0, 0, 3 * h}; Point(6) = {left, top, 0, 3 * h}; Point(7) = {right, top, 0, 3 * h}; Point(8) = {right, 0, 0, 3 * h};
  Circle(1) = {2, 1, 3}; Circle(2) = {3, 1, 4};
  Line(3) = {4, 5}; Line(4) = {5, 6}; Line(5) = {6, 7}; Line(6) = {7, 8}; Line(7) = {8, 2};
  Transfinite Curve {1, 2} = n / 2 + 1;
  Curve Loop(1) = {1 : 7};
  Plane Surface(1) = {1};
  Physical Curve("dome") = {1, 2};
  Physical Curve("inlet") = {4};
  Physical Curve("outlet") = {6};
  Physical Curve("walls") = {3, 5, 7};
  Physical Surface("channel") = {1};
Else
  // Two quarters of a ring, between the pump and the dome or through the dome.
  in = part == 0 ? a : r; out = part == 0 ? r : R; k = part == 0 ? n / 3 : m;
  Point(2) = {in, 0, 0}; Point(3) = {0, in, 0}; Point(4) = {-in, 0, 0};
  Point(5) = {out, 0, 0}; Point(6) = {0, out, 0}; Point(7) = {-out, 0, 0};
  Circle(1) = {2, 1, 3}; Circle(2) = {3, 1, 4}; Circle(3) = {5, 1, 6}; Circle(4) = {6, 1, 7};
  Line(5) = {2, 5}; Line(6) = {3, 6}; Line(7) = {4, 7};
  Transfinite Curve {1 : 4} = n / 2 + 1;
  Transfinite Curve {5 : 7} = k + 1;
  Curve Loop(1) = {5, 3, -6, -1}; Curve Loop(2) = {6, 4, -7, -2};
  Plane Surface(1) = {1}; Plane Surface(2) = {2};
  Transfinite Surface {1, 2};
  Recombine Surface {1, 2};
  If (part == 0)
    Physical Curve("pump") = {1, 2};
    Physical Curve("floor") = {5, 7};
    Physical Curve("dome") = {3, 4};
    Physical Surface("inside") = {1, 2};
  Else
    Physical Curve("inner") = {1, 2};
    Physical Curve("outer") = {3, 4};
    Physical Curve("foot") = {5, 7};
    Physical Surface("rubber") = {1, 2};
  EndIf
EndIf
