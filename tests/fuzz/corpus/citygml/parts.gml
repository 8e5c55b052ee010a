<?xml version="1.0" encoding="UTF-8"?>
<core:CityModel xmlns:core="http://www.opengis.net/citygml/2.0" xmlns:bldg="http://www.opengis.net/citygml/building/2.0" xmlns:gen="g" xmlns:gml="http://www.opengis.net/gml" xmlns:xlink="x">
<gml:boundedBy><gml:Envelope srsName="urn:adv:crs:ETRS89_UTM32*DE_DHHN2016_NH" srsDimension="3"/></gml:boundedBy>
<core:cityObjectMember><bldg:Building gml:id="b">
<gen:stringAttribute name="owner"><gen:value>town &amp; church</gen:value></gen:stringAttribute>
<bldg:lod1Solid><gml:Solid><gml:exterior><gml:CompositeSurface><gml:surfaceMember><gml:Polygon gml:id="p"><gml:exterior><gml:LinearRing><gml:posList>0 0 0 10 0 0 10 10 0 0 10 0 0 0 0</gml:posList></gml:LinearRing></gml:exterior><gml:interior><gml:LinearRing><gml:pos>2 2 0</gml:pos><gml:pos>2 4 0</gml:pos><gml:pos>4 4 0</gml:pos></gml:LinearRing></gml:interior></gml:Polygon></gml:surfaceMember></gml:CompositeSurface></gml:exterior></gml:Solid></bldg:lod1Solid>
<bldg:boundedBy><bldg:RoofSurface gml:id="r"><bldg:lod2MultiSurface><gml:MultiSurface><gml:surfaceMember xlink:href="#p"/></gml:MultiSurface></bldg:lod2MultiSurface></bldg:RoofSurface></bldg:boundedBy>
<bldg:consistsOfBuildingPart><bldg:BuildingPart gml:id="part"><bldg:lod2MultiSurface><gml:Polygon><gml:exterior><gml:LinearRing><gml:coordinates>0,0,5 6,4,5 6,0,5 0,2,5 0,0,5</gml:coordinates></gml:LinearRing></gml:exterior></gml:Polygon></bldg:lod2MultiSurface></bldg:BuildingPart></bldg:consistsOfBuildingPart>
<bldg:boundedBy><bldg:ClosureSurface gml:id="c"/></bldg:boundedBy>
</bldg:Building></core:cityObjectMember></core:CityModel>
