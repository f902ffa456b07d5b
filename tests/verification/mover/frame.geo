// SPDX-License-Identifier: Apache-2.0
// A block of side 1 in the midst of a frame of side 2: triangles (kind 0), quadrilaterals (1), or a cube in a box in
// tetrahedra (2).
DefineConstant[ kind = 0, n = 6 ];  // edges over the gap of 0.5
h = 0.5 / n;
x() = {0, 0.5, 1.5, 2};
m() = {n, 2 * n, n};
If (kind < 2)
  For j In {0 : 3}
    For i In {0 : 3}
      Point(1 + i + 4 * j) = {x(i), x(j), 0, h};
    EndFor
  EndFor
  For j In {0 : 3}
    For i In {0 : 3}
      If (i < 3)
        Line(100 + i + 4 * j) = {1 + i + 4 * j, 2 + i + 4 * j};
        Transfinite Curve {100 + i + 4 * j} = m(i) + 1;
      EndIf
      If (j < 3)
        Line(200 + i + 4 * j) = {1 + i + 4 * j, 5 + i + 4 * j};
        Transfinite Curve {200 + i + 4 * j} = m(j) + 1;
      EndIf
    EndFor
  EndFor
  s() = {};
  For j In {0 : 2}
    For i In {0 : 2}
      If (i != 1 || j != 1)
        k = i + 4 * j;
        Curve Loop(k + 1) = {100 + k, 201 + k, -(104 + k), -(200 + k)};
        Plane Surface(k + 1) = {k + 1};
        Transfinite Surface {k + 1};
        If (kind == 1)
          Recombine Surface {k + 1};
        EndIf
        s() += {k + 1};
      EndIf
    EndFor
  EndFor
  Physical Curve("ymin") = {100 : 102};
  Physical Curve("ymax") = {112 : 114};
  Physical Curve("xmin") = {200, 204, 208};
  Physical Curve("xmax") = {203, 207, 211};
  Physical Curve("block") = {105, 109, 205, 206};
  Physical Surface("fluid") = {s()};
Else
  SetFactory("OpenCASCADE");
  Box(1) = {0, 0, 0, 2, 2, 2};
  Box(2) = {0.5, 0.5, 0.5, 1, 1, 1};
  BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
  inner() = Surface In BoundingBox {0.4, 0.4, 0.4, 1.6, 1.6, 1.6};
  Physical Surface("xmin") = Surface In BoundingBox {-0.1, -0.1, -0.1, 0.1, 2.1, 2.1};
  Physical Surface("xmax") = Surface In BoundingBox {1.9, -0.1, -0.1, 2.1, 2.1, 2.1};
  Physical Surface("ymin") = Surface In BoundingBox {-0.1, -0.1, -0.1, 2.1, 0.1, 2.1};
  Physical Surface("ymax") = Surface In BoundingBox {-0.1, 1.9, -0.1, 2.1, 2.1, 2.1};
  Physical Surface("zmin") = Surface In BoundingBox {-0.1, -0.1, -0.1, 2.1, 2.1, 0.1};
  Physical Surface("zmax") = Surface In BoundingBox {-0.1, -0.1, 1.9, 2.1, 2.1, 2.1};
  Physical Surface("block") = {inner()};
  Physical Volume("fluid") = {3};
  MeshSize{:} = h;
EndIf
