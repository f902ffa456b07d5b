// SPDX-License-Identifier: Apache-2.0
DefineConstant[ nx = 20, ny = 4, L = 0.5, h = 0.05, y0 = 0 ];
Point(1)={0,y0,0}; Point(2)={L,y0,0}; Point(3)={L,y0+h,0}; Point(4)={0,y0+h,0};
Line(1)={1,2}; Line(2)={2,3}; Line(3)={3,4}; Line(4)={4,1};
Curve Loop(1)={1,2,3,4}; Plane Surface(1)={1};
Transfinite Curve {1,3}=nx+1; Transfinite Curve {2,4}=ny+1; Transfinite Surface{1}; Recombine Surface{1};
Physical Curve("left")={4}; Physical Curve("right")={2}; Physical Curve("low")={1}; Physical Curve("top")={3};
Physical Surface("bar")={1};
