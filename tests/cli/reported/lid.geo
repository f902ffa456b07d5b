// SPDX-License-Identifier: Apache-2.0
DefineConstant[ y = 0, h = 0.25, nx = 16, ny = 4 ];
Point(1)={0,y,0}; Point(2)={1,y,0}; Point(3)={1,y+h,0}; Point(4)={0,y+h,0};
Line(1)={1,2}; Line(2)={2,3}; Line(3)={3,4}; Line(4)={4,1};
Transfinite Curve{1,3}=nx+1; Transfinite Curve{2,4}=ny+1;
Curve Loop(1)={1:4}; Plane Surface(1)={1}; Transfinite Surface{1}; Recombine Surface{1};
Physical Curve("low")={1}; Physical Curve("right")={2}; Physical Curve("top")={3}; Physical Curve("left")={4}; Physical Surface("all")={1};
